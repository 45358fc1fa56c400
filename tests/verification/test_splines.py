"""Splines as meshes: exact geometry, order of convergence, what is kept, refusals."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
ARC = np.array([(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
ALL_SIDES = [("x0", "x1"), ("y0", "y1")]


def ring() -> vv.SplinePatch:
    """A quarter of a ring between radius 1 and 2."""
    return vv.SplinePatch(
        degrees=(2, 2),
        knots=([0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 1]),
        control=np.stack([ARC, 1.5 * ARC, 2 * ARC]),
        weights=np.outer(np.ones(3), [1.0, 0.5**0.5, 1.0]),
    )


def test_refinement_leaves_the_geometry() -> None:
    coarse, fine = ring(), ring().refined(3)
    xi = np.random.default_rng(1).uniform(size=(20, 2))
    np.testing.assert_allclose(coarse.at(xi), fine.at(xi), atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(fine.at(xi), axis=1), 1 + xi[:, 0], atol=1e-14)
    assert fine.counts == (3, 3)
    assert fine.smoothness == 1


def test_area_of_the_ring() -> None:
    body = mixture(ring().refined(4))
    assert body.integral(vv.System([body]).x) == pytest.approx(0.5 * 3 * np.pi / 4, rel=1e-6)


def test_second_derivatives_on_a_curved_patch() -> None:
    """``laplace |X|^2 = 4``, and ``|X|^2`` is a rational function of the patch's own space, but for its degree."""
    body = mixture(ring().refined(8))
    square = body.space.fitted((body.points**2).sum(axis=1))
    table = body.space.cells()[0]
    assert table.laplacians is not None
    laplace = np.einsum("mqk,mk->mq", table.laplacians, square[table.numbers])
    assert np.average(laplace, weights=table.size) == pytest.approx(4.0, rel=1e-3)


def mixture(mesh: Any, **options: Any) -> vv.CahnHilliard:
    given = {
        "free_energy": vv.DoubleWell(barrier=1.0),
        "gradient_energy": 0.6,
        "concentration": 0.5,
        **options,
    }
    return vv.CahnHilliard(mesh=mesh, **given)


def error(degree: int, n: int, form: str, periodic: bool) -> float:
    """At the end of ``c = 1/2 + cos(pi x) cos(pi y) exp(-t) / 4``, with a source."""
    kappa, M, pi, end = 0.3, 0.5, np.pi, 0.01

    def exact(t: float, X: Array) -> Array:
        return 0.5 + 0.25 * np.cos(pi * X[:, 0]) * np.cos(pi * X[:, 1]) * np.exp(-t)

    def source(t: float, X: Array) -> Array:
        u, x, y = exact(t, X) - 0.5, pi * X[:, 0], pi * X[:, 1]
        slope = (0.25 * np.exp(-t) * pi) ** 2 * ((np.sin(x) * np.cos(y)) ** 2 + (np.cos(x) * np.sin(y)) ** 2)
        laplace = 2 * ((6 * u**2 - 0.5) * (-2 * pi**2 * u) + 12 * u * slope)
        return -u - M * (laplace - kappa * 4 * pi**4 * u)

    L = 2 if periodic else 1
    body = mixture(
        vv.SplineBox(size=(L, L), counts=(L * n, L * n), degree=degree),
        gradient_energy=kappa,
        mobility=M,
        concentration=lambda X: exact(0.0, X),
        form=form,
        periodic=ALL_SIDES if periodic else [],
    )
    system = vv.System([body, vv.ConcentrationSource(body=body, rate=source)])
    vv.simulate(system, until=end, step=5e-4)
    table, c = body.space.cells()[0], body.coefficients(body.phase, system.x)
    off = table.at(c) - exact(end, table.X.reshape(-1, 3)).reshape(table.size.shape)
    return float(np.sqrt((table.size * off**2).sum()))


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize(
    ("form", "degree", "order"),
    [("mixed", 2, 3), ("mixed", 3, 4), ("mixed", 4, 5), ("direct", 2, 2), ("direct", 3, 4), ("direct", 4, 5)],
)
def test_order_in_space(form: str, degree: int, order: int, periodic: bool) -> None:
    coarse, fine = (error(degree, n, form, periodic) for n in (4, 8))
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.5)
    assert np.log2(coarse / fine) > order - 0.1


@pytest.mark.parametrize("form", ["mixed", "direct"])
def test_mass_is_kept_and_energy_falls(form: str) -> None:
    rng = np.random.default_rng(2)
    body = mixture(
        vv.SplineBox(size=(16, 16), counts=(12, 12), degree=2),
        free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
        gradient_energy=2.0,
        mobility=5.0,
        concentration=lambda X: 0.5 + 0.02 * rng.standard_normal(len(X)),
        form=form,
        periodic=ALL_SIDES,
    )
    system = vv.System([body])
    mass = body.integral(system.x)
    result = vv.simulate(system, until=20.0, step=0.5)
    assert body.integral(system.x) == pytest.approx(mass, rel=1e-13)
    assert np.all(np.diff(result.ledger["potential_stored"]) < 0)
    if form == "mixed":
        assert result.conservation()["energy"] < 1e-10


def test_box_in_space() -> None:
    """Degree 3 in three dimensions: 64 functions in an element."""
    cube = vv.SplineBox(size=(1, 1, 1), counts=(2, 2, 2), degree=3)
    body = mixture(cube, concentration=lambda X: 0.5 + 0.1 * X[:, 0])
    result = vv.simulate(vv.System([body]), until=0.1, step=0.05)
    assert result.conservation()["energy"] < 1e-10


UP = [0, 0, 1, 1]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: vv.SplinePatch(degrees=(1, 1), knots=(UP, [0, 1, 0, 1]), control=np.zeros((2, 2, 2))),
            "knots of direction 1 are not ascending: 1 is followed by 0",
        ),
        (
            lambda: vv.SplinePatch(degrees=(1, 1), knots=(UP, UP), control=np.zeros((2, 3, 2))),
            "needs 5 knots, not 4",
        ),
        (lambda: vv.SplinePatch(degrees=(5, 1), knots=(UP, UP), control=np.zeros((2, 2, 2))), "degree 5"),
        (
            lambda: vv.SplinePatch(
                degrees=(1, 1), knots=(UP, UP), control=np.zeros((2, 2, 2)), weights=-np.ones((2, 2))
            ),
            "all positive",
        ),
        (
            lambda: mixture(vv.SplineBox(size=(1, 1), counts=(2, 2)), periodic=[("x0", "x1")]),
            "needs 3 spans at least",
        ),
        (
            lambda: mixture(vv.SplineBox(size=(1, 1), counts=(4, 4)), periodic=[("x0", "y1")]),
            "are opposite ones",
        ),
        (
            lambda: mixture(ring().refined(2), periodic=[("x0", "x1")]),
            "nothing says that it is smooth across the ends of direction 0",
        ),
        (lambda: mixture(ring().refined(4), form="direct"), "sides without flux of vv.SplineBox alone"),
        (
            lambda: mixture(vv.SplineBox(size=(1, 1), counts=(4, 4), degree=1), form="direct"),
            "first derivatives",
        ),
        (lambda: mixture(vv.RectangleMesh(size=(1, 1), counts=(4, 4)), form="direct"), "first derivatives"),
        (
            lambda: vv.Wetting(
                body=mixture(vv.SplineBox(size=(1, 1), counts=(4, 4)), form="direct"), faces="y0", angle=60.0
            ),
            "without a potential; take form = 'mixed'",
        ),
    ],
)
def test_refusals(make: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=re.escape(words)):
        make()


def test_a_patch_that_is_not_smooth_where_it_is_wrapped_has_no_direct_form() -> None:
    """A knot that stands twice there: first derivatives jump, as at one within."""
    along, across = np.array([-2.0, 0, 0, 1, 2, 4, 4, 5, 6]), np.array([0.0, 0, 0, 1, 2, 3, 4, 4, 4])
    places = [[np.mean(t[i + 1 : i + 3]) for i in range(6)] for t in (along, across)]
    patch = vv.SplinePatch(
        degrees=(2, 2),
        knots=(along, across),
        control=np.stack(np.meshgrid(*places, indexing="ij"), axis=-1),
        wrapped=(0,),
    )
    assert patch.smoothness == 0
    mixture(patch, gradient_energy=30.0, periodic=[("x0", "x1")])
    with pytest.raises(vv.InputError, match="form = 'direct' needs splines whose first derivatives are"):
        mixture(patch, gradient_energy=30.0, periodic=[("x0", "x1")], form="direct")


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_concentrations_of_sides_that_meet(degree: int) -> None:
    """Each side fits the same function by itself, a little otherwise in the corner: they contradicted each other."""

    def given(t: float, X: Array) -> Array:
        return np.asarray(0.5 + 0.1 * np.sin(3 * X[:, 0] + 2 * X[:, 1]) * (1 + t))

    errors = []
    for n in (4, 8):
        body = mixture(
            vv.SplineBox(size=(1.1, 0.7), counts=(n, n), degree=degree), concentration=lambda X: given(0.0, X)
        )
        sides = [
            vv.PrescribedConcentration(body=body, nodes=side, value=given)
            for side in ("x0", "y0", "x1", "y1")
        ]
        system = vv.System([body, *sides])
        result = vv.simulate(system, until=0.2, step=0.1)
        assert result.conservation()["energy"] < 1e-10
        edge = np.unique(np.concatenate([body.nodes(side) for side in ("x0", "y0", "x1", "y1")]))
        errors.append(np.abs(body.values(system.x) - given(0.2, body.points))[edge].max())
    assert np.log2(errors[0] / errors[1]) > degree + 0.5


def test_concentrations_of_sides_that_contradict_each_other() -> None:
    body = mixture(vv.SplineBox(size=(1, 1), counts=(4, 4), degree=2))
    sides = [vv.PrescribedConcentration(body=body, nodes=n, value=c) for n, c in (("x0", 0.5), ("y0", 0.6))]
    with pytest.raises(vv.InputError, match=r"at concentrations of 0.5 and 0.6 at t = 0"):
        vv.System([body, *sides])


def test_sources_of_the_direct_form_bring_their_potential_and_the_audit_says_what_no_account_has() -> None:
    """All that a uniform mixture gains is brought: ``V (f(c1) - f(c0))``. What diffusion dissipates is not booked."""
    well = vv.DoubleWell(barrier=5.0, low=0.3, high=0.7)
    for wave in (0.0, 0.05):
        alloy = vv.CahnHilliard(
            mesh=vv.SplineBox(size=(16, 16), counts=(12, 12), degree=3),
            free_energy=well,
            gradient_energy=2.0,
            mobility=5.0,
            concentration=lambda X, wave=wave: 0.5 + wave * np.cos(np.pi * X[:, 0] / 8),
            form="direct",
            name="alloy",
        )
        system = vv.System([alloy, vv.ConcentrationSource(body=alloy, rate=0.05)])
        result = vv.simulate(system, until=2.0, step=0.05)
        if wave:
            said = "not meant to be exact: CahnHilliard 'alloy' has form = 'direct', whose ledger lacks what"
            assert said in result.audit()
            assert "WRONG" not in result.audit()
        else:
            gained = 16**2 * float(well.values(0.6) - well.values(0.5))
            assert result.ledger["work_source"][-1] == pytest.approx(gained, rel=1e-3)
            assert result.ledger["total"][-1] - result.ledger["total"][0] == pytest.approx(gained, rel=1e-10)
