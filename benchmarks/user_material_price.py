"""What the energy of a material in Python costs beside the same material of the package: processor time per element.

    python benchmarks/user_material_price.py [counts]

The same neo-Hooke, by the package and as `UserMaterial`, on a cube of counts^3 elements (half as many along the
edges for all but hex8). Assembly of residual and tangent of the energy-momentum scheme, best of five; then the whole
step, which solves the equations as well, best of three.
"""

from __future__ import annotations

import os
import sys
import time

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import numpy as np

import visviva as vv

YOUNG, POISSON = 1000.0, 0.3
LAMBDA, SHEAR = YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON), YOUNG / 2 / (1 + POISSON)
CALLS = [0, 0]  # of the user's function, and of points in them


def energy(C: np.ndarray) -> np.ndarray:
    """Neo-Hooke of C (6, n)."""
    CALLS[0] += 1
    CALLS[1] += C.shape[1]
    J2 = (
        C[0] * (C[1] * C[2] - C[4] ** 2)
        - C[3] * (C[3] * C[2] - C[4] * C[5])
        + C[5] * (C[3] * C[4] - C[1] * C[5])
    )
    logarithm = np.log(J2)
    return SHEAR / 2 * (C[0] + C[1] + C[2] - 3 - logarithm) + LAMBDA / 8 * logarithm**2


MATERIALS = {
    "NeoHooke": lambda: vv.NeoHooke(young=YOUNG, poisson=POISSON),
    "UserMaterial": lambda: vv.UserMaterial(function=energy),
}


def cube(material: vv.Material, cell: str, n: int) -> vv.System:
    """A cube that turns and strains."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n), cell=cell)
    solid = vv.Solid(
        mesh=mesh,
        material=material,
        density=1.0,
        velocity=lambda X: X * [[1, 0, -1]],
        angular_velocity=(1, 2, 3),
    )
    return vv.System([solid])


def assembly(system: vv.System) -> float:
    """Seconds of residual and tangent with their scatter, in the middle of a step."""
    step = vv.EnergyMomentum().step(0.0, 0.01)
    system.core.discard()
    system.core.dx[:] = 0.01 * system.v
    signals, residual, values = system.signals(step), np.zeros(len(system.x)), np.zeros(system.core.n_entries)
    best = np.inf
    for _ in range(5):
        CALLS[:], start = [0, 0], time.process_time()
        system.core.assemble(step, signals, residual, values)
        best = min(best, time.process_time() - start)
    return best


def stepping(name: str, cell: str, n: int, steps: int = 3) -> tuple[float, float]:
    """Seconds and iterations of a step."""
    best = (np.inf, 0.0)
    for _ in range(3):
        system, iterations = cube(MATERIALS[name](), cell, n), 0
        system.step(0.01)
        start = time.process_time()
        for _ in range(steps):
            iterations += system.step(0.01).iterations
        best = min(best, ((time.process_time() - start) / steps, iterations / steps))
    return best


def main() -> None:
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 8
    print(f"{'':20s} assembly us/element  ratio  points/element  step us/element  ratio  iterations")
    for cell, count in (
        ("hex8", n),
        ("tet4", n // 2),
        ("tet10", n // 2),
        ("hex20", n // 2),
        ("hex27", n // 2),
    ):
        base: tuple[float, ...] = ()
        for name in MATERIALS:
            system = cube(MATERIALS[name](), cell, max(count, 1))
            system.step(0.01)
            n_cells = system.components[0].grid.n_cells
            took, points = assembly(system), CALLS[1] / n_cells
            step, iterations = stepping(name, cell, max(count, 1))
            base = base or (took, step)
            a, b = 1e6 * took / n_cells, 1e6 * step / n_cells
            ratios = took / base[0], step / base[1]
            left = f"{cell:6s} {name:13s} {a:19.2f} {ratios[0]:6.1f} {points:15.0f}"
            print(f"{left} {b:16.1f} {ratios[1]:6.1f} {iterations:11.1f}")


if __name__ == "__main__":
    main()
