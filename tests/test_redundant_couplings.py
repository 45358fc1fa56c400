"""Frames on faces that are held twice: constraints that follow from others are found by name, nothing else changes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import visviva as vv


def brick(counts: tuple[int, int, int] = (1, 1, 1)) -> vv.Solid:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=counts)
    return vv.Solid(mesh=mesh, material=vv.NeoHooke(young=100.0, poisson=0.3), density=1.0, name="brick")


def pulled(*, overlaps: bool) -> vv.System:
    """A brick that stands on z0, and a frame on x1, whose lower edge stands there as well, that a force pulls at."""
    solid = brick()
    end = vv.RigidCoupling(solid=solid, faces="x1", name="end")
    parts = [solid, end, vv.Fixed(solid=solid, nodes="z0" if overlaps else "x0")]
    return vv.System([*parts, vv.Force(on=end.point(), force=(1, 0, 0))])


def welded(
    *, times: int, counts: tuple[int, int, int] = (1, 1, 1), newton: vv.Newton | None = None
) -> vv.System:
    solid = brick(counts)
    end = vv.RigidCoupling(solid=solid, faces="x1", name="end")
    body = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(1.5, 0.5, 0.5), name="body")
    welds = [vv.Rigid(a=end, b=body, at=(1, 0.5, 0.5), name=f"weld {k}") for k in range(times)]
    held = vv.Fixed(solid=solid, nodes="x0")
    parts = [solid, end, body, *welds, held, vv.Force(on=body.point(), force=(0, 1, 0))]
    return vv.System(parts, newton=newton)


CASES: dict[str, tuple[Callable[[], vv.System], str]] = {
    "support overlaps a coupling": (lambda: pulled(overlaps=True), "end"),
    "body welded twice": (lambda: welded(times=2), "weld 1"),
    "body welded three times to a finer brick": (lambda: welded(times=3, counts=(2, 1, 2)), "weld 2"),
}


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Static()], ids=str)
@pytest.mark.parametrize("name", CASES)
def test_redundant_constraints_are_named(name: str, scheme: vv.Scheme) -> None:
    """Factors of the constraints were exactly singular."""
    build, owner = CASES[name]
    system = build()
    result = vv.simulate(system, until=0.02, step=0.01, scheme=scheme)
    assert system.report is not None
    assert any(owner in r.component for r in system.report.redundant), system.report
    assert result.conservation()["constraints"] < 1e-10
    assert np.isfinite(system.x).all()


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Static()], ids=str)
def test_a_second_weld_changes_no_motion(scheme: vv.Scheme) -> None:
    places = []
    for times in (1, 2):
        system = welded(times=times)
        vv.simulate(system, until=0.1, step=0.02, scheme=scheme)
        body = next(c for c in system.components if isinstance(c, vv.RigidBody))
        places.append(body.point().position.value(system.x))
    np.testing.assert_allclose(places[0], places[1], atol=1e-9)
    assert places[0][1] > 0.5


def test_a_support_that_overlaps_holds_the_frame() -> None:
    """Its lower edge stands: the frame can only turn about it."""
    system = pulled(overlaps=True)
    vv.simulate(system, until=1.0, step=0.5, scheme=vv.Static())
    end = next(c for c in system.components if isinstance(c, vv.RigidCoupling))
    for y in (0.0, 1.0):
        np.testing.assert_allclose(
            end.point((0, y - 0.5, -0.5)).position.value(system.x), (1, y, 0), atol=1e-9
        )
    top = end.point((0, -0.5, 0.5)).position.value(system.x)
    assert np.hypot(top[0] - 1, top[2]) == pytest.approx(1.0, abs=1e-9)
    assert top[0] > 1


@pytest.mark.parametrize("linear", [vv.Direct(), vv.Direct(library="eigen")], ids=str)
def test_factors_of_the_whole_matrix_serve_as_well(linear: vv.Direct) -> None:
    """They called it singular, where what looks for redundant constraints went on."""
    motions = []
    for choice in (None, linear):
        system = welded(times=3, counts=(2, 1, 2), newton=vv.Newton(linear=choice))
        result = vv.simulate(system, until=0.1, step=0.01)
        body = next(c for c in system.components if isinstance(c, vv.RigidBody))
        motions.append(body.point().position.value(system.x))
        assert result.statistics.rejected == 0
    np.testing.assert_allclose(motions[0], motions[1], atol=1e-11)
