"""What cracks carry that are given by `damage`: along a line of nodes, in a row of cells, and as a slit of the mesh.

    python benchmarks/line_of_damage.py [--counts 20 40 80 160]

A square plate, cracked from its left edge to its middle, is drawn a little by its upper edge, in plane strain and far
below what lets the crack grow. Prints the work of that over the work on the plate with a slit, of the
same cells.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
MODELS: list[tuple[Any, Any]] = [(m, s) for m in ("AT1", "AT2") for s in ("none", "spectral")]


def work(n: int, crack: str, model: Any, split: Any) -> float:
    """On the upper edge, of n by n cells and a length of cracks of two of them."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(n, n)).build()
    if crack == "slit":
        mesh = mesh.opened(
            lambda X: (np.abs(X[:, 1] - 0.5) < 1e-9) & (X[:, 0] < 0.5 - 1e-9), lambda X: X[:, 1] > 0.5
        )
    rows = {"slit": -1.0, "line": 1e-9, "cells": 1.0 / n + 1e-9}[crack]

    def damage(X: Array) -> Array:
        above = X[:, 1] - 0.5
        return ((above > -1e-9) & (above < rows) & (X[:, 0] < 0.5 + 1e-9)).astype(float)

    solid = vv.FracturingSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.2),
        toughness=1.0,
        length=2.0 / n,
        model=model,
        split=split,
        damage=damage,
    )
    held = vv.Fixed(solid=solid, nodes="y0")
    system = vv.System([solid, held, vv.Prescribed(solid=solid, nodes="y1", motion=(0.0, "1e-5*t", None))])
    result = vv.quasi_static(system, until=1.0, step=1.0)
    return float(np.diff(result.ledger["work_prescribed motion"][[0, -1]])[0])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--counts", type=int, nargs="+", default=[20, 40, 80, 160], help="cells along an edge"
    )
    counts = parser.parse_args().counts
    print("model  split     cells  line of nodes  row of cells")
    for model, split in MODELS:
        for n in counts:
            slit = work(n, "slit", model, split)
            line, cells = (work(n, crack, model, split) / slit for crack in ("line", "cells"))
            print(f"{model:5s}  {split:8s}  {n:5d}  {line:13.3f}  {cells:12.3f}")


if __name__ == "__main__":
    main()
