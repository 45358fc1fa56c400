"""Attributes that have another name say it."""

from __future__ import annotations

import pytest

import visviva as vv


@pytest.mark.parametrize(("old", "new"), [("touch", "invalidate"), ("take_stock", "evaluate_ledger")])
def test_system_says_what_it_is_called_now(old: str, new: str) -> None:
    system = vv.System([vv.PointMass(mass=1.0)])
    assert callable(getattr(system, new))
    with pytest.raises(AttributeError, match=rf"System\.{old} is System\.{new} now"):
        getattr(system, old)


def test_the_package_says_what_a_component_is_called_now() -> None:
    with pytest.raises(AttributeError, match=r"visviva\.HeatLink is visviva\.HeatExchange now"):
        vv.HeatLink  # type: ignore[attr-defined]  # noqa: B018
