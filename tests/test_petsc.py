"""Options of PETSc, and what is said where it is missing; `tests/processes` has the rest."""

from __future__ import annotations

import importlib.util

import pytest

import visviva as vv
from visviva.base import world as seam
from visviva.linear.choice import Problem
from visviva.linear.petsc import settings


def test_options_are_read_as_petsc_writes_them() -> None:
    assert settings("-ksp_view -ksp_rtol 1e-8 -shift -1e-3 -name 'two words'") == {
        "ksp_view": "",
        "ksp_rtol": "1e-8",
        "shift": "-1e-3",
        "name": "two words",
    }
    with pytest.raises(vv.InputError, match="'ksp_rtol' belongs to no -name"):
        vv.Petsc("ksp_rtol 1e-8")


def test_petsc_is_refused_where_it_is_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(seam, "PACKAGE", "visviva_that_is_missing")
    assert importlib.util.find_spec(seam.PACKAGE) is None
    with pytest.raises(
        vv.InputError, match=r"linear=Petsc\(\.\.\.\): needs visviva-petsc, which is not installed"
    ):
        vv.Petsc().choose(Problem(n=1, n_entries=1))
