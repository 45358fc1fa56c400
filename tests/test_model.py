"""What components hand over to the core: batches of equal stencils."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.component.component import Component
from visviva.model import stencil
from visviva.model.field import Role
from visviva.model.form import product
from visviva.model.law import quadratic


def bodies(n: int) -> list[vv.RigidBody]:
    """Unlike bodies at unlike places."""
    return [
        vv.RigidBody(mass=1.0 + k, inertia=(1, 1, 1), position=(k, 0, 0), velocity=(0, k, 0))
        for k in range(n)
    ]


def test_equal_bodies_share_the_stencil_of_their_rigidity(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = []
    compile_strains = stencil.stencil
    monkeypatch.setattr(stencil, "stencil", lambda s: compiled.append(s) or compile_strains(s))
    system = vv.System(bodies(20))
    assert len(compiled) == 1
    assert len(system.model.elements) == 20


def test_shared_stencils_mean_each_body_its_own_unknowns() -> None:
    parts = bodies(3)
    system = vv.System(parts)
    system.x[system.field(parts[1], "configuration").start + 3] = 1.5  # stretches its first director
    residual = system.residual(vv.EnergyMomentum().step(0.0, 1.0))
    for part, stretch in zip(parts, (0.0, 0.5 * (1.5**2 - 1), 0.0), strict=True):
        rows = system.field(part, "rigidity").unknowns
        assert residual[rows] == pytest.approx([stretch, 0, 0, 0, 0, 0], abs=1e-15)


def test_initial_values_are_there_while_fields_are_being_made() -> None:
    system = vv.System(bodies(20))
    x, v = system.model.initial
    assert np.array_equal(x, system.x)
    assert np.array_equal(v, system.v)


@pytest.mark.parametrize(
    "scheme", [vv.Static(), vv.EnergyMomentum(), vv.VariationalMidpoint(), vv.GeneralizedAlpha()]
)
@pytest.mark.parametrize("cell", ["hex8", "tet10"])
def test_where_all_is_prescribed_there_are_stresses(cell: str, scheme: vv.Scheme) -> None:
    """Nothing is left to solve: a bar stretched by a tenth, node by node."""
    mesh = vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1), cell=cell)
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=100.0, poisson=0.0), density=1.0)
    pull = vv.Prescribed(solid=solid, nodes="all", motion=lambda t, X: t * X * np.array([0.1, 0, 0]))
    system = vv.System([solid, pull])
    result = vv.simulate(system, until=1.0, step=0.25, scheme=scheme)
    assert np.abs(solid.nodal("cauchy", system.x) - [10, 0, 0, 0, 0, 0]).max() < 1e-12
    assert result.ledger["potential_strain"][-1] == pytest.approx(1.0)
    if not isinstance(scheme, vv.GeneralizedAlpha):
        assert result.ledger["work_prescribed motion"][-1] == pytest.approx(1.0)
    assert system.check().tangent is None
    with pytest.raises(vv.InputError, match="no modes; leave something free"):
        vv.modes(system)


def test_potentials_of_transport_are_refused() -> None:
    """What is transported has no forces: its equation, rates alone, was left singular or its value wrong."""

    class Heat(Component):
        def declare(self, model: Any) -> None:
            self.temperature = model.field(self, "temperature", [1.0, 2.0], role=Role.CONTENT)

        def contribute(self, model: Any) -> None:
            e = self.temperature.form(1) * 3.0
            model.potential(self, "heat", [product(e, e)], quadratic(2.0))

    with pytest.raises(
        vv.InputError, match=r"'oven' has a potential of temperature\[1\].*of order 1.*vv.Term"
    ):
        vv.System([Heat(name="oven"), vv.PointMass(mass=1.0)])
