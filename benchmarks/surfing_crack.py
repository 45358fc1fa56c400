"""The example `surfing` on cells of several sizes: what cells add to the toughness, and the price.

python benchmarks/surfing_crack.py [--cells 3 4 6] [--model AT1 AT2]
"""

from __future__ import annotations

import argparse
import time

import visviva as vv
from visviva.examples import surfing


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cells", type=float, nargs="+", default=[4.0], help="per length")
    parser.add_argument("--model", nargs="+", default=["AT1", "AT2"])
    args = parser.parse_args()
    for model in args.model:
        for cells in args.cells:
            begun, study = time.process_time(), surfing.study(model, cells=cells)
            result = vv.quasi_static(study.system, until=study.until, step=study.step, scheme=study.scheme)
            energy, work, expected = surfing.toughness(result)
            print(
                f"{model}, l / h = {cells:g}: crack energy per length {energy / surfing.TOUGHNESS:.4f} Gc, work "
                f"{work / surfing.TOUGHNESS:.4f} Gc, expected {expected / surfing.TOUGHNESS:.4f} Gc, "
                f"{100 * (energy / expected - 1):+.2f} %; {result.statistics.steps} steps, "
                f"{result.statistics.iterations} iterations, {time.process_time() - begun:.0f} s",
                flush=True,
            )


if __name__ == "__main__":
    main()
