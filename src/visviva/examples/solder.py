"""Solder: two phases with misfit and moduli of their own separate in a plate of splines that is held at one side.

The numbers are the author's own, in the manner of tin and lead: no published set of the paper's reference [1] was at
hand. The free energy is a regular solution with the excess terms of Redlich and Kister, cooled below its critical
temperature. Stress is in balance at every step, since the plate has no mass; backward Euler damps the jump into it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
PHASES = 0.0941, 0.8504
"""Of the alloy without stress."""


def study(count: int = 16, until: float = 60.0, misfit: float = 0.03) -> vv.Study:
    """A plate of 32 with `count` quadratic splines along each side; strain per concentration `misfit`."""
    rng = np.random.default_rng(5)
    noise = 0.02 * rng.standard_normal((2 * count + 1) ** 2)

    def start(X: Array) -> Array:
        return np.asarray(0.5 + noise[: len(X)])

    energy = vv.RegularSolution(temperature=350.0, excess=(7.6e3, 600.0), volume=8.31446261815324 * 350.0)
    alloy = vv.SplineMixtureSolid(
        mesh=vv.SplineBox(size=(32, 32), counts=(count, count), degree=2),
        material=vv.NeoHooke(young=30.0, poisson=0.35),
        free_energy=energy,
        gradient_energy=6.0,
        mobility=4.0,
        concentration=start,
        eigenstrain=misfit,
        reference=0.5,
        moduli=(0.8,),
        name="solder",
    )
    held = vv.Fixed(solid=alloy, nodes="x0", name="pad")
    return vv.Study(
        vv.System([alloy, held]),
        until,
        0.2,
        vv.BackwardEuler(),
        probes={
            "interfaces": vv.InterfaceArea(body=alloy, phases=PHASES),
            "rich": vv.PhaseVolume(body=alloy, above=0.5),
            "wavelength": vv.DomainSize(body=alloy),
        },
        fields=("concentration", "von_mises"),
        adaptive=vv.Adaptive(tolerance=2e-3, max_step=5.0),
        title="Phases of a solder",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Chemical, gradient and elastic energy fall together; the amounts of the components stay; phases are there."""
    assert np.all(np.diff(result.ledger["potential_stored"]) < 1e-12)
    (alloy,) = (c for c in result.system.components if isinstance(c, vv.MixtureSolid))
    c = alloy.values(result.system.x)
    assert c.max() - c.min() > 0.3, f"compositions from {c.min():g} to {c.max():g}"
    assert alloy.elastic_energy(result.system.x) > 0
    assert abs(alloy.integral(result.system.x) / alloy.integral(result.states[0]) - 1) < 1e-9
