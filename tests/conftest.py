"""Fixtures that run a test over every line of the catalogue and over every scheme."""

from __future__ import annotations

import gc

import pytest
from catalogue import CATALOGUE, Entry

import visviva as vv

SCHEMES = [
    vv.EnergyMomentum(),
    vv.Midpoint(),
    vv.VariationalMidpoint(),
    vv.BackwardEuler(),
    vv.BDF2(),
    vv.GeneralizedAlpha(0.8),
    vv.Static(),
]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """A test whose name holds an address is another one in each process that runs tests: none of them would run."""
    if named := [item.nodeid for item in items if " at 0x" in item.nodeid]:
        raise pytest.UsageError(f"names with addresses, give them ids=: {named[:3]}")


def pytest_collection_finish() -> None:
    """Thousands of collected cases stay to the end: the garbage collector need not look at them again and again."""
    gc.collect()
    gc.freeze()


@pytest.fixture(params=CATALOGUE, ids=lambda e: e.name.replace(", ", "-").replace(" ", "_"))
def entry(request: pytest.FixtureRequest) -> Entry:
    """A line of the catalogue."""
    return request.param  # type: ignore[no-any-return]


@pytest.fixture(params=SCHEMES, ids=lambda s: type(s).__name__)
def scheme(request: pytest.FixtureRequest) -> vv.Scheme:
    """A scheme of each kind."""
    return request.param  # type: ignore[no-any-return]
