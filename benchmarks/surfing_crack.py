"""A crack that surfs along a strip, drawn by the field around a moving tip: the toughness that cells of finite size add.

All of the boundary follows the displacements of Irwin's mode I field of a tip that moves along. After it the energy of the
crack grows per length by Gc (1 + h / 2l) with AT2 and Gc (1 + 3h / 8l) with AT1 (Bourdin, Francfort & Marigo 2008), and by as
much more than the elastic energy changes does the boundary work.

    python benchmarks/surfing_crack.py [--cells 4 6] [--model AT1 AT2]
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from notched_plate import graded

import visviva as vv

YOUNG, POISSON, TOUGHNESS, LENGTH = 1.0, 0.2, 1e-8, 0.04
WIDTH, HALF, NOTCH = 1.0, 0.3, 0.25


def field(X: np.ndarray, tip: float, intensity: float) -> np.ndarray:
    """Displacements (n, 3) in plane strain of mode I; crack faces at y = 0, both sides by the sign of y."""
    x, y = X[:, 0] - tip, X[:, 1]
    r, a = np.hypot(x, y), np.arctan2(y, x)
    mu, kappa = YOUNG / (2 * (1 + POISSON)), 3 - 4 * POISSON
    size = intensity / (2 * mu) * np.sqrt(r / (2 * np.pi)) * (kappa - np.cos(a))
    return np.stack([size * np.cos(a / 2), size * np.sin(a / 2), 0 * a], axis=1)


def strip(model: str, cells: float, excess: float = 1.2) -> vv.System:
    """`cells` per length where the crack runs, which is along a row of them as thick as they are."""
    h = LENGTH / cells
    x = graded(0, 0.0, 0.9, WIDTH, h, 0.05)
    half = graded(h / 2, h / 2, h / 2 + 2 * LENGTH, HALF, h, 0.05)
    rows = np.concatenate([-half[::-1], half])
    unit = vv.RectangleMesh(size=(1, 1), counts=(len(x) - 1, len(rows) - 1)).build()
    i, j = np.rint(unit.points * (len(x) - 1, len(rows) - 1)).astype(int).T
    mesh = vv.Mesh(np.stack([x[i], rows[j]], axis=1), unit.cells, face_sets=unit.face_sets)
    notch = x[np.argmin(np.abs(x - NOTCH))]

    def broken(X: np.ndarray) -> np.ndarray:
        """The best profile around a row of broken cells."""
        away = np.maximum(np.abs(X[:, 1]) - h / 2, 0) / LENGTH
        profile = np.maximum(1 - away / 2, 0) ** 2 if model == "AT1" else np.exp(-away)
        ahead = np.maximum(X[:, 0] - notch, 0) / LENGTH
        return profile * (np.maximum(1 - ahead / 2, 0) ** 2 if model == "AT1" else np.exp(-ahead))

    solid = vv.FracturingSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=YOUNG, poisson=POISSON),
        toughness=TOUGHNESS,
        length=LENGTH,
        model=model,  # type: ignore[arg-type]
        damage=broken,
        name="strip",
    )
    intensity = np.sqrt(excess * TOUGHNESS * YOUNG / (1 - POISSON**2))
    nodes = np.unique(np.concatenate([mesh.nodes(name) for name in ("x0", "x1", "y0", "y1")]))

    def motion(t: float, X: np.ndarray) -> np.ndarray:
        return field(X, NOTCH - 0.1 + t, intensity) * min(t / 0.05, 1.0)

    return vv.System([solid, vv.Prescribed(solid=solid, nodes=nodes, motion=motion, name="around")])


def surf(model: str, cells: float, until: float = 0.55, step: float = 0.01) -> tuple[float, float, float]:
    """Toughness per Gc by the crack's energy and by the work of the boundary, and the expected one."""
    system = strip(model, cells)
    solid = system.components[0]
    scheme = vv.AlternateMinimization(newton=2, unstable=True, energy_tolerance=1e-6)
    result = vv.quasi_static(system, until=until, step=step, scheme=scheme)
    tip = vv.CrackTip(solid=solid, along=(1, 0, 0), level=0.9)
    reach, energy = [], []
    for x in result.states:
        system.x[:] = x
        reach.append(tip(system)[0])
        energy.append(solid.crack_energy(x))
    reach, energy = np.array(reach), np.array(energy)
    stored, work = result.ledger["potential_stored"], result.ledger["work_prescribed motion"]
    steady = (reach > NOTCH + 4 * LENGTH) & (reach < WIDTH - 0.1 - 4 * LENGTH)
    first, last = np.flatnonzero(steady)[[0, -1]]
    length = reach[last] - reach[first]
    by_energy = (energy[last] - energy[first]) / length / TOUGHNESS
    done = work[last] - work[first]
    released = (done - (stored - energy)[last] + (stored - energy)[first]) / length / TOUGHNESS
    share = 1 / (2 * cells) if model == "AT2" else 3 / (8 * cells)
    return by_energy, released, 1 + share


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cells", type=float, nargs="+", default=[4])
    parser.add_argument("--model", nargs="+", default=["AT1", "AT2"])
    parser.add_argument("--step", type=float, default=0.01)
    args = parser.parse_args()
    for model in args.model:
        for cells in args.cells:
            begun = time.process_time()
            energy, work, expected = surf(model, cells, step=args.step)
            print(
                f"{model}, l / h = {cells:g}: crack energy per length {energy:.4f} Gc, work {work:.4f} Gc, expected "
                f"{expected:.4f}: {100 * (energy / expected - 1):+.2f} %; {time.process_time() - begun:.0f} s",
                flush=True,
            )


if __name__ == "__main__":
    main()
