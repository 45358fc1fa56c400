"""Bad input of fluids is refused with name, value and cure."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
SQUARE = vv.RectangleMesh(size=(1, 1), counts=(2, 2))


def water(**options: Any) -> vv.Fluid:
    return vv.Fluid(**({"mesh": SQUARE, "density": 1.0, "viscosity": 0.1, "name": "water"} | options))


@pytest.mark.parametrize("name", ["density", "viscosity"])
@pytest.mark.parametrize("value", [0.0, -2.0])
def test_density_and_viscosity_are_positive(name: str, value: float) -> None:
    with pytest.raises(vv.InputError, match=rf"Fluid 'water': {name} = {value:g} is not positive"):
        water(**{name: value})


@pytest.mark.parametrize("elements", ["Q1P0", "Q2Q2", "P1P0"])
def test_unstable_pairs(elements: str) -> None:
    with pytest.raises(vv.InputError, match=rf"'{elements}' is unstable.*take one of Q2Q1"):
        water(elements=elements)


def test_unknown_pair_and_unfit_cells() -> None:
    with pytest.raises(vv.InputError, match="'Taylor-Hood' does not exist; take one of"):
        water(elements="Taylor-Hood")
    with pytest.raises(
        vv.InputError, match="P2P1 elements are built on tri6 or tri3, and its mesh has quad4"
    ):
        water(elements="P2P1")
    with pytest.raises(vv.InputError, match=r"no fluid elements on quad8.*Mesh.quadratic"):
        water(mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad8"))
    with pytest.raises(vv.InputError, match=r"Fluid 'water': .*dimension 2 in 3 dimensions"):
        water(mesh=vv.Mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], {"quad4": [(0, 1, 2, 3)]}))


def test_cells_of_both_orders() -> None:
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    mesh = vv.Mesh(
        [*square, (2, 0), (1.5, 0), (1.5, 0.5), (1, 0.5)],
        {"quad4": [(0, 1, 2, 3)], "tri6": [(1, 4, 2, 5, 6, 7)]},
    )
    with pytest.raises(vv.InputError, match=r"'water': cells of first and second order \(quad4, tri6\)"):
        water(mesh=mesh)


def test_bare_boundary() -> None:
    fluid = water()
    with pytest.raises(
        vv.InputError, match=r"'water': 2 faces .* no condition, one of them at \[.*\]; give them vv.NoSlip"
    ):
        vv.System([fluid, *[vv.NoSlip(fluid=fluid, faces=s) for s in ("x0", "x1", "y0")]])


def test_faces_with_two_conditions() -> None:
    fluid = water()
    lid = vv.VelocityBoundary(fluid=fluid, faces="y1", velocity=(1, 0, 0), name="lid")
    with pytest.raises(vv.InputError, match=r"'lid' and NoSlip 'wall' both have the face at"):
        vv.System([fluid, lid, vv.NoSlip(fluid=fluid, faces="all", name="wall")])


def test_prescribed_velocities_that_disagree() -> None:
    fluid = water()
    inlet = vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=(1, 0, 0), name="inlet")
    lid = vv.VelocityBoundary(fluid=fluid, faces="y1", velocity=(2, 0, 0), name="lid")
    rest = [vv.NoSlip(fluid=fluid, faces="y0"), vv.Outlet(fluid=fluid, faces="x1")]
    with pytest.raises(vv.InputError, match=r"'lid': at \[0.0, 1.0\] .* \[2.0, 0.0\], and .* \[1.0, 0.0\]"):
        vv.System([fluid, inlet, lid, *rest])


def closed(speed: Any) -> list[Any]:
    """A channel with inflow and outflow both prescribed."""
    fluid = water()
    inlet = vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=(1, 0, 0), name="inlet")
    outlet = vv.VelocityBoundary(fluid=fluid, faces="x1", velocity=(speed, 0, 0), name="exit")
    return [fluid, inlet, outlet, *[vv.FreeSlip(fluid=fluid, faces=s) for s in ("y0", "y1")]]


def test_inflow_that_does_not_leave() -> None:
    with pytest.raises(
        vv.InputError, match=r"'water': at t = 0 1 flows in and 0.5 out .* difference of 0.5 .* vv.Outlet"
    ):
        vv.System(closed(0.5))


def test_inflow_that_stops_leaving_later() -> None:
    """The step that would begin it fails, and the last state is kept."""
    system = vv.System(closed("1 - 0.5*step(t - 0.25)"))
    with pytest.raises(vv.RunError, match=r"at t = 0.3 1 flows in and 0.5 out"):
        vv.simulate(system, until=1.0, step=0.1)
    assert system.time == pytest.approx(0.2)


def test_a_little_imbalance_is_taken_off_the_outflow() -> None:
    components = closed(0.9995)
    system = vv.System(components)
    vv.simulate(system, until=0.2, step=0.1)
    rates = [vv.FlowRate(fluid=components[0], faces=s)(system) for s in ("x0", "x1")]
    assert rates == pytest.approx([-1.0, 1.0], abs=1e-14)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda f: vv.VelocityBoundary(fluid=f, faces="y1", velocity=(0, 0, 1)), "out of its plane"),
        (lambda f: vv.VelocityBoundary(fluid=f, faces="y1", velocity=(None, None, 1)), "no component"),
        (
            lambda f: vv.VelocityBoundary(fluid=f, faces="y1", velocity=lambda t, X: X[:, :2]),
            r"shape \(3, 2\)",
        ),
        (lambda f: vv.VelocityBoundary(fluid=f, faces="y1", velocity=lambda t, X: X / 0), "finite"),
        (lambda f: vv.FluidTraction(fluid=f, faces="y1", traction=(0, 0, 1)), "out of its plane"),
        (lambda f: vv.NoSlip(fluid=f, faces="top"), "no set of faces|no set of nodes or faces"),
        (lambda f: vv.FlowField(fluid=f, field="vortex"), "vorticity"),
        (lambda f: vv.FlowField(fluid=f, at=(2, 0, 0)), r"place \[2.0, 0.0\] lies outside"),
        (lambda f: vv.FlowField(fluid=f, at=(1e200, 0, 0)), r"place \[1e\+200, 0.0\] lies outside"),
    ],
)
def test_conditions_and_probes_that_do_not_fit(make: Any, message: str) -> None:
    with np.errstate(all="ignore"), pytest.raises(vv.InputError, match=message):
        make(water())


def test_unequal_periodic_faces() -> None:
    mesh = vv.QuadrilateralMesh(corners=[(0, 0), (1, 0), (1, 1.5), (0, 1)], counts=(2, 2))
    with pytest.raises(vv.InputError, match=r"'x0' \(3\) moved by .* do not meet those of 'x1'"):
        water(mesh=mesh, periodic=(("x0", "x1"),))


def test_a_condition_without_its_fluid() -> None:
    fluid, other = water(), water(name="oil")
    conditions = [vv.NoSlip(fluid=fluid, faces="all"), vv.NoSlip(fluid=other, faces="all")]
    with pytest.raises(vv.InputError, match="Fluid 'oil', which is not in the system"):
        vv.System([fluid, *conditions])


def test_backflow_that_blows_up_is_told_of() -> None:
    """Eddies driven through an opening ever faster: the step fails, the message says where, the last state is kept."""
    fluid = water(mesh=vv.RectangleMesh(size=(3, 1), counts=(6, 3)), viscosity=0.01)
    profile = lambda t, X: 4 * X[:, 1:2] * (1 - X[:, 1:2]) * [1.0, 0, 0]  # noqa: E731
    push = lambda t, X: np.exp(60 * t) * (0.5 - X[:, 1:2]) * [1.0, 0, 0]  # noqa: E731
    inlet = vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=profile)
    opening = vv.FluidTraction(fluid=fluid, faces="x1", traction=push, name="exit")
    walls = [vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1")]
    system = vv.System([fluid, inlet, *walls, opening])
    assert opening.trouble(system.x) == ""
    with pytest.raises(
        vv.RunError, match=r"'exit': fluid comes back in at \[3.0, 0\.[67].* downstream of the eddies"
    ):
        vv.simulate(system, until=2.0, step=0.05)
    assert 0.1 < system.time < 0.5
    assert np.isfinite(system.x).all()


@pytest.mark.parametrize("start", [1.0, 0.0])
@pytest.mark.parametrize(
    "shape",
    [
        lambda x: x > x.max() - 0.3,
        lambda x: x - x.mean(),
        lambda x: np.full(len(x), 1.0 / len(x)),
        lambda x: x * (x.max() - x),  # nothing at both ends
    ],
    ids=["last", "mean", "length", "parabola"],
)
def test_a_body_force_that_looks_at_other_points_is_refused(shape: Any, start: float) -> None:
    """Processes ask it of their own points: a fan at the end of a channel blew a third more with two of them."""
    mesh = vv.RectangleMesh(size=(2, 1), counts=(4, 2), cell="quad9")

    def fan(t: float, X: Any) -> Any:
        return (start + t) * shape(X[:, 0])[:, None] * [1.0, 0.0, 0.0]

    def pushed() -> None:
        fluid = water(mesh=mesh, body_force=fan)
        vv.simulate(vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all")]), until=0.1, step=0.1)

    with pytest.raises(
        vv.InputError, match=r"'water': its body force at .* of this point alone .* X.mean\(\)"
    ):
        pushed()


def test_a_body_force_that_is_small_beside_another_is_looked_at_too() -> None:
    """A fan that begins while something else pushes; values of neural networks and squeezed ones are no other ones."""
    mesh = vv.RectangleMesh(size=(2, 1), counts=(4, 2), cell="quad9")

    def fan(t: float, X: Any) -> Any:
        on = (X[:, 0] > X[:, 0].max() - 0.3) * (t > 0.1) * 0.5
        return np.stack([on, -9.81 + 0 * on, 0 * on], axis=1)

    def rough(t: float, X: Any) -> Any:
        push = np.squeeze(np.sin(X[:, :1] + t)).astype(np.float32)
        return np.stack([push, 0 * push, 0 * push], axis=1)

    fluids = [water(mesh=mesh, body_force=force) for force in (fan, rough)]
    marched = [vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all")]) for fluid in fluids]
    with pytest.raises(vv.InputError, match=r"of this point alone .* X.mean\(\)"):
        vv.simulate(marched[0], until=0.3, step=0.1)
    vv.simulate(marched[1], until=0.3, step=0.1)
