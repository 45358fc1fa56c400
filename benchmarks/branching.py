"""Branching crack of Borden et al. (2012): when it branches, how fast its tip is, what balances, by length.

    python benchmarks/branching.py [--length 1.0] [--cells 2] [--step 0.5] [--until 80]

The example `branching`. Their crack branches at 34 to 46 us, slower than 0.6 of Rayleigh's waves.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import visviva as vv
from visviva.examples import branching


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--length", type=float, default=1.0, help="mm")
    parser.add_argument("--cells", type=float, default=2.0, help="per length")
    parser.add_argument("--step", type=float, default=0.5, help="us")
    parser.add_argument("--until", type=float, default=80.0, help="us")
    given = parser.parse_args()
    study = branching.study(1e-3 * given.length, given.cells, 1e-6 * given.step)
    plate = study.system.components[0]
    print(f"{plate.grid.n_cells} cells, {study.system.core.n_equations} equations")
    print("time/us  tip/mm  above/mm  crack J/m  imbalance  iterations  processor s")
    began, times, states, off, iterations = time.process_time(), [0.0], [study.system.x.copy()], 0.0, 0
    for until in np.arange(4.0, given.until + 1e-9, 4.0):
        result = vv.simulate(study.system, until=1e-6 * until, step=study.step)
        times += list(result.times[1:])
        states += list(result.states[1:])
        off, iterations = max(off, result.conservation()["energy"]), iterations + result.statistics.iterations
        tip, above = branching.fronts(plate, states[-1])
        print(
            f"{until:7g} {1e3 * tip:7.2f} {1e3 * above:9.2f} {2 * plate.crack_energy(states[-1]):10.4f} {off:10.1e} "
            f"{iterations:11d} {time.process_time() - began:12.1f}",
            flush=True,
        )
    when, speed = branching.branched(plate, np.array(times), states)
    print(
        f"branches at {1e6 * when:.1f} us; tip at most {speed:.0f} m/s, {speed / branching.RAYLEIGH:.2f} of Rayleigh's"
    )


if __name__ == "__main__":
    main()
