"""What functions of the user ask other processes is answered or refused by name, and nobody waits for ever."""

from __future__ import annotations

import json
from typing import Any

import pytest

from processes import asking
from processes.launch import ROOT, launched, missing

MADE_OF = {
    "MeshBody": "Solid",
    "UserMaterial": "Solid",
    "UserHeat": "ThermoelasticSolid",
    "a UserTerm": "UserTerm",
    "a term of an own component": "Own",
} | dict.fromkeys(("UserFreeEnergy", "UserMobility", "RegularSolution", "ArrheniusMobility"), "CahnHilliard")
"""Components whose functions these are, where they are none themselves."""


def test_every_argument_that_takes_a_function_is_tried() -> None:
    assert {f"{owner}.{argument}" for owner, argument in asking.taking_functions()} <= set(asking.CASES)


def is_right(case: str, who: str, found: Any, right: dict[str, list[float]]) -> bool:
    """Whether systems end as where nobody asks, or by an error that says whose function asked.

    While systems are made it may say what each process was to do.
    """
    if isinstance(found, list):
        return bool(found == pytest.approx(right[case], rel=1e-9))
    owner = case.split(".")[0]
    named = any(name in found for name in (f"{MADE_OF.get(owner, owner)} '", f" {owner}: ", f" {owner}, "))
    said = "made" in found or "processes differ: process 0 is to " in found
    return ("InputError: " in found and named) or (who == "at the start" and said)


@pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
def test_functions_that_ask_others_end_by_an_answer_or_an_error() -> None:
    """Who asked in heat that comes into what deforms, or alone in what all call, waited for ever."""
    done = launched(2, "-W", "ignore", str(ROOT / "tests" / "processes" / "asking.py"), limit=150)
    assert done.returncode == 0, [*done.stdout.splitlines()[-1:], done.stderr]
    lines: list[tuple[str, str, Any]] = [json.loads(line) for line in done.stdout.splitlines()]
    right = {case: found for case, who, found in lines if who == "() in steps"}
    assert list(right) == list(asking.CASES)
    assert [line for line in lines if not is_right(*line, right)] == []
