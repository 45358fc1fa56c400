"""Natural convection in a square box at the Rayleigh numbers 10^3 to 10^6, against converged Nusselt numbers.

python benchmarks/convection.py [--largest 1e6]
"""

from __future__ import annotations

import argparse
import time

import visviva as vv
from visviva.examples.convection import CONVERGED, heat_of, study

COUNTS = {1e3: 10, 1e4: 16, 1e5: 20, 1e6: 24}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--largest", type=float, default=1e6, help="largest Rayleigh number")
    given = parser.parse_args()
    print("Rayleigh   n    hot        cold       converged  off       seconds")
    for rayleigh, count in COUNTS.items():
        if rayleigh > given.largest:
            continue
        start = time.process_time()
        case = study(rayleigh=rayleigh, count=count)
        result = vv.simulate(case.system, until=case.until, step=case.step, scheme=case.scheme)
        hot, cold = (vv.HeatFlow(body=heat_of(result), nodes=side)(result.system) for side in ("x0", "x1"))
        off = 100 * (hot / CONVERGED[rayleigh] - 1)
        seconds = time.process_time() - start
        print(
            f"{rayleigh:8.0e} {count:4d} {hot:10.6f} {cold:10.6f} {CONVERGED[rayleigh]:10.4f} "
            f"{off:+8.4f} % {seconds:6.1f}"
        )


if __name__ == "__main__":
    main()
