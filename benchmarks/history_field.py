"""What the history field of Miehe does otherwise than active sets: damage, peaks, and the balance of energy.

A bar of steel is pulled, let go and pulled further (damages, and the energy that drives them when it is let go); a
coarse notched plate is pulled apart to and fro (force at the peak, area of the crack at the end); a bar flies apart
(largest error of the sum of kinetic, elastic and crack energy, by the first).

    python benchmarks/history_field.py
"""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv

BOTH = ("active set", "history")
STEEL, STRAIN = vv.SaintVenantKirchhoff(young=1.0, poisson=0.0), 1e-5


def bar(**options: Any) -> tuple[vv.FracturingSolid, vv.Result]:
    """Pulled to the strength, let go, pulled by a fifth further; its strains are small."""
    mesh = vv.RectangleMesh(size=(2, 1), counts=(2, 1))
    solid = vv.FracturingSolid(mesh=mesh, material=STEEL, toughness=3 * STRAIN**2, length=1.5, **options)
    held = [
        vv.Fixed(solid=solid, nodes="x0", directions=(True, False, False)),
        vv.Fixed(solid=solid, nodes=[0]),
    ]
    table = [(0, 0), (1, 2 * STRAIN), (2, 0), (3, 2.4 * STRAIN)]
    moved = vv.Prescribed(solid=solid, nodes="x1", motion=(table, None, None))
    system = vv.System([solid, *held, moved])
    return solid, vv.quasi_static(system, until=3.0, step=0.05, scheme=vv.Static(unstable=True))


def notched(**options: Any) -> tuple[float, float]:
    """Largest force and area of the crack of a unit square with a notch to its middle, 20 x 20 cells of l / 2."""
    square = vv.RectangleMesh(size=(1, 1), counts=(20, 20), origin=(0, -0.5)).build()
    mesh = square.opened(lambda X: (np.abs(X[:, 1]) < 1e-9) & (X[:, 0] < 0.5 - 1e-9), lambda X: X[:, 1] > 0)
    material = vv.SaintVenantKirchhoff(young=1.0, poisson=0.2)
    solid = vv.FracturingSolid(mesh=mesh, material=material, toughness=1e-6, length=0.1, **options)
    moved = vv.Prescribed(solid=solid, nodes="y1", motion=(0, "3e-3*t", None))
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="y0"), moved])
    force, area = vv.SupportForce(solid=solid, nodes="y1"), vv.CrackArea(solid=solid)
    found = [0.0]
    scheme = vv.AlternateMinimization(unstable=True)
    for _ in vv.march(system, until=1.0, step=0.02, scheme=scheme):
        found.append(float(force(system)[1]))
        if found[-1] < 0.2 * max(found):
            break
    return max(found), area(system)


def flying(**options: Any) -> tuple[vv.FracturingSolid, vv.Result]:
    """A bar whose ends fly apart."""
    solid = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(4, 1), counts=(16, 4)),
        material=vv.NeoHooke(young=100.0, poisson=0.3),
        density=1.0,
        toughness=0.02,
        length=0.5,
        velocity=lambda X: np.stack([1.1 * (X[:, 0] - 2), 0 * X[:, 0], 0 * X[:, 0]], axis=1),
        **options,
    )
    return solid, vv.simulate(vv.System([solid]), until=0.3, step=0.01)


def main() -> None:
    print(f"{'':17}{'bar: d at peak':>16}{'let go':>9}{'end':>9}{'plate: peak':>14}{'area':>9}{'energy':>12}")
    for model in ("AT2", "AT1"):
        for kind in BOTH:
            solid, result = bar(model=model, irreversibility=kind)
            d = [float(solid.damages(result.states[k]).max()) for k in (20, 40, 60)]
            peak, area = notched(model=model, irreversibility=kind)
            error = flying(model=model, irreversibility=kind)[1].conservation()["energy"]
            print(f"{model} {kind:12} {d[0]:16.6f}{d[1]:9.6f}{d[2]:9.6f}{peak:14.4e}{area:9.3f}{error:12.1e}")


if __name__ == "__main__":
    main()
