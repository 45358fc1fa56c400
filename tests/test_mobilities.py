"""Mobilities beyond where they are fitted, and where they vanish."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from test_tangents import differences

import visviva as vv

SCHEMES: list[tuple[vv.Scheme, vv.Adaptive | None]] = [
    (vv.EnergyMomentum(), None),
    (vv.EnergyMomentum(), vv.Adaptive(tolerance=1e-3)),
    (vv.Midpoint(), None),
    (vv.BDF2(), None),
    (vv.GeneralizedAlpha(), None),
]
BOWL = vv.PolynomialEnergy(coefficients=(0.0, 0.0, 5.0), centre=0.5)
STEEP = vv.UserMobility(function=lambda c: np.exp(-4 * c), high=0.6)
"""Its polynomial is off by a thousandth at 0.79."""


def mixture(kind: str, mobility: Any, **options: Any) -> Any:
    given: dict[str, Any] = {
        "free_energy": BOWL,
        "gradient_energy": 1.0,
        "concentration": 0.55,
        "mobility": mobility,
        "name": "alloy",
        **options,
    }
    square: Any = vv.RectangleMesh(size=(1, 1), counts=(3, 3))
    if kind == "order":
        return vv.AllenCahn(mesh=square, order=given.pop("concentration"), **given)
    if kind == "solid":
        steel = vv.SaintVenantKirchhoff(young=10.0, poisson=0.3)
        return vv.MixtureSolid(mesh=square, material=steel, density=1.0, **given)
    if kind == "mesh":
        return vv.CahnHilliard(mesh=square, **given)
    box = vv.SplineBox(size=(1, 1), counts=(3, 3), degree=2)
    return vv.CahnHilliard(mesh=box, form=kind, **given)


@pytest.mark.parametrize("kind", ["mesh", "mixed", "direct", "order", "solid"])
@pytest.mark.parametrize(("scheme", "adaptive"), SCHEMES)
def test_no_step_ends_where_the_mobility_is_not_the_function(
    kind: str, scheme: vv.Scheme, adaptive: Any
) -> None:
    """Filled by a source it went on with a polynomial of degree 7; beyond `high` that still holds for a while."""
    body = mixture(kind, STEEP)
    system = vv.System([body, vv.ConcentrationSource(body=body, rate=20.0 if kind == "order" else 1.0)])
    words = (
        r"alloy' near \(0.*an? \w+ of (0\.[678]\d*) is above high = 0.6 of its UserMobility, whose polynomial"
    )
    with pytest.raises(vv.StepFailure, match=words) as error:
        vv.simulate(system, until=2.0, step=0.02, scheme=scheme, adaptive=adaptive)
    reached, found = body.values(system.x), re.search(words, str(error.value))
    assert found
    beyond = float(found[1])
    assert 0.6 < reached.max() < beyond * (1 + 1e-6)  # as it is written
    given = [np.exp(-4 * c) for c in (reached, np.array(beyond))]
    off, too_far = (np.abs(STEEP.values(c) / M - 1) for c, M in zip((reached, beyond), given, strict=True))
    assert off.max() <= 0.01 < too_far * (1 + 1e-4)


def test_a_mixture_may_pass_the_range_where_the_function_is_a_polynomial() -> None:
    """``c (1 - c)``, which is cut at zero as that of `DegenerateMobility`, gives the same run beyond 1."""
    ends = []
    for mobility in (vv.UserMobility(function=lambda c: 4 * c * (1 - c)), vv.DegenerateMobility(scale=1.0)):
        body = mixture("mesh", mobility, concentration=lambda X: 0.97 + 0.02 * np.cos(3 * X[:, 0]))
        system = vv.System([body, vv.ConcentrationSource(body=body, rate=1.0)])
        vv.simulate(system, until=0.2, step=0.02)
        ends.append(body.values(system.x))
    assert ends[0].max() > 1.1
    np.testing.assert_allclose(*ends, rtol=1e-9)


def test_statics_ends_where_the_mobility_is_not_the_function() -> None:
    body = mixture("solid", STEEP)
    held = vv.PrescribedConcentration(body=body, nodes="x0", value="0.55 + 0.02 * t")
    system = vv.System([body, vv.Fixed(solid=body, nodes="x0"), held])
    with pytest.raises(
        vv.RunError, match=r"MixtureSolid 'alloy' near .* is above high = 0.6 of its UserMobility"
    ):
        vv.quasi_static(system, until=20.0, step=1.0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: mixture("mesh", STEEP, concentration=0.9),
            "at the start a concentration of 0.9 is above high",
        ),
        (
            lambda: mixture("solid", STEEP, concentration=0.9),
            "at the start a concentration of 0.9 is above high",
        ),
        (
            lambda: mixture(
                "order",
                vv.ArrheniusMobility(base=STEEP, activation=1.0, temperature=300.0),
                concentration=0.9,
            ),
            "at the start an order of 0.9 is above high = 0.6 of its UserMobility",
        ),
        (
            lambda: mixture("mesh", vv.UserMobility(function=np.sqrt, low=0.1), concentration=-0.1),
            "a concentration of -0.1 is below low = 0.1 of its UserMobility, whose polynomial gives 0 there, "
            "and whose function nan",
        ),
        (
            lambda: mixture("order", vv.DegenerateMobility(scale=1.0), concentration=1.2),
            "AllenCahn 'alloy': its mobility vanishes at the order 1.2 of the start",
        ),
    ],
)
def test_starts_beyond_are_refused(make: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=re.escape(words)):
        make()


@pytest.mark.parametrize("steep", [1.0, 3.0, 5.0])
def test_slow_phases_have_their_mobility(steep: float) -> None:
    mobility, c = vv.UserMobility(function=lambda c: np.exp(steep * c)), np.linspace(0, 1, 1001)
    np.testing.assert_allclose(mobility.values(c), np.exp(steep * c), rtol=0.01)


@pytest.mark.parametrize("steep", [6.0, 7.0, 8.0, 9.0])
def test_slow_phases_that_no_polynomial_follows_are_refused(steep: float) -> None:
    """By a thousandth of the largest alone that of the slow phase was a third to one and a half of what it is."""
    words = r"polynomial of degree 7 off by .*, more than 0.001 of its largest value, or 0.01 of that; give the comp"
    with pytest.raises(vv.InputError, match=words):
        vv.UserMobility(function=lambda c: np.exp(steep * c))


@pytest.mark.parametrize("kind", ["mesh", "mixed", "direct"])
def test_nothing_moves_where_the_mobility_is_cut(kind: str) -> None:
    """The direct form took the slope of the polynomial there, and moved by it, against the gradient of µ or along."""
    body = mixture(
        kind, vv.DegenerateMobility(scale=1.0), concentration=lambda X: 1.3 + 0.1 * np.cos(3 * X[:, 0])
    )
    system = vv.System([body])
    start = body.values(system.x)
    vv.simulate(system, until=1.0, step=0.1)
    np.testing.assert_allclose(body.values(system.x), start, atol=1e-13)


@pytest.mark.parametrize("low", [1.1, 0.85])
def test_the_tangent_of_the_direct_form_where_the_mobility_is_cut(low: float) -> None:
    """Beyond, and across: no point of quadrature is so near to the kink that a difference is taken over it."""
    body = mixture(
        "direct",
        vv.DegenerateMobility(scale=1.0),
        concentration=lambda X: low + 0.3 * X[:, 0] * (1 + X[:, 1]),
    )
    system = vv.System([body])
    step = vv.EnergyMomentum().step(0.3, 0.4)
    _, K = system.tangent(step)
    np.testing.assert_allclose(K.toarray(), differences(system, step, system.free_unknowns), atol=1e-9)
