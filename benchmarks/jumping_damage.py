"""What jumps of damage cost that steps which balance forces in their middle are let go on after.

    python benchmarks/jumping_damage.py

A plate that is held all around and cracks evenly; its free strain jumps in time. By the energy-momentum scheme damage
goes beyond its balance, to where the energy is that of before, and stays there; by backward Euler it ends in balance.
Prints both damages and how much more energy the plate has than in balance, of what is stored there.
"""

from __future__ import annotations

import contextlib
import io

import numpy as np

import visviva as vv

JUMPS = {"AT2": (0.2, (-0.06, -0.1, -0.14, -0.2)), "AT1": (0.02, (-0.051, -0.052, -0.0525, -0.053))}
"""Toughness, and strains to jump to."""


def jumped(model: str, toughness: float, strain: float, scheme: vv.Scheme) -> tuple[float, float]:
    """Damage and energy after the jump."""
    body = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.0),
        density=1e-3,
        toughness=toughness,
        length=1.0,
        model=model,  # type: ignore[arg-type]
        free_strain=lambda t, X: np.full(len(X), strain if t > 0.05 else 0.0),
    )
    system = vv.System([body, vv.Fixed(solid=body, nodes="all")])
    result = vv.simulate(system, until=0.1, step=0.01, scheme=scheme)
    return float(body.damages(system.x).max()), float(result.ledger["total"][-1])


def main() -> None:
    print("model  strain  damage  in balance  energy above that in balance")
    for model, (toughness, strains) in JUMPS.items():
        for strain in strains:
            d, energy = jumped(model, toughness, strain, vv.BackwardEuler())
            try:
                with contextlib.redirect_stderr(io.StringIO()):
                    beyond, more = jumped(model, toughness, strain, vv.EnergyMomentum())
            except vv.StepFailure:
                print(f"{model:5s}  {strain:6g}  refused  {d:9.4f}")
                continue
            print(f"{model:5s}  {strain:6g}  {beyond:6.4f}  {d:10.4f}  {more / energy - 1:.1e}")


if __name__ == "__main__":
    main()
