"""Particles with misfit that diffusion brings to their shapes: aspects by size beside those of the best ellipses.

python benchmarks/misfit_particle.py [--ratios 0.9 1.2 1.5 2] [--widths 0.25 0.125]

The example `misfit` until nothing moves. Interfaces have a width by the critical radius; ellipses have sharp ones.
"""

from __future__ import annotations

import argparse
import time

import visviva as vv
from visviva.examples import misfit


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--ratios", type=float, nargs="+", default=[0.9, 1.2, 1.5, 2.0])
    parser.add_argument("--widths", type=float, nargs="+", default=[0.25, 0.125])
    parser.add_argument("--until", type=float, default=30.0)
    given = parser.parse_args()
    print(" width  start  radius  aspect  best ellipse  steps  processor s")
    for width in given.widths:
        for ratio in given.ratios:
            began = time.process_time()
            study = misfit.study(ratio=ratio, width=width, inner=2 + 1.4 * ratio, until=given.until)
            alloy = study.system.components[0]
            result = vv.simulate(
                study.system, until=study.until, step=study.step, scheme=study.scheme, adaptive=study.adaptive
            )
            radius, aspect = misfit.shape(alloy, study.system.x)
            ellipse = misfit.best_aspect(radius, misfit.SOFTNESS)
            print(
                f"{width:6g} {ratio:6g} {radius:7.3f} {aspect:7.3f} {ellipse:13.3f} "
                f"{result.statistics.steps:6d} {time.process_time() - began:12.1f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
