"""Which solvers of PETSc solve the linear equations of a step."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from petsc4py import PETSc

from visviva import _core
from visviva.base.errors import InputError
from visviva.base.world import world
from visviva.linear.choice import Choice, Direct, LinearOptions, Problem, Temperatures
from visviva_petsc.gathered import Gathered
from visviva_petsc.solver import Solver

MULTIGRID = {
    "pc_type": "gamg",
    "pc_gamg_threshold": "0.02",
    "mg_levels_ksp_type": "chebyshev",
    "mg_levels_pc_type": "jacobi",
}
"""Aggregates of nodes on the rigid motions of solids."""
LOOSE, FEW = "1e-3", "100"
"""Iterations that conjugate gradients may take at short steps, and their tolerance: Newton goes on anyway."""
FACTORS = ("mumps", "superlu_dist")
"""Packages that factor what processes share, in the order of preference."""
REFINED = {"ksp_type": "gmres", "ksp_rtol": "1e-12", "ksp_max_it": "20"}
"""Iterations that make up for pivots that were moved."""


@dataclass(frozen=True)
class Petsc(LinearOptions):
    """Solve by PETSc: in one process, or in all that share the system.

    Solids by conjugate gradients with aggregation multigrid (GAMG) on their rigid motions, in short time steps with
    blocks of nodes first; where that fails by GMRES with the same. Heat alone by multigrid as well. Everything else by
    factors: of MUMPS or SuperLU_DIST, if PETSc was built with them, else of the whole matrix in the first process.

    Parameters
    ----------
    options : str
        Of PETSc, such as ``"-ksp_view -ksp_rtol 1e-8"``; they go before those that are chosen here.

    Examples
    --------
    >>> import visviva as vv
    >>> from visviva_petsc import Petsc
    >>> rubber, mesh = vv.NeoHooke(young=1e3, poisson=0.3), vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    >>> block = vv.Solid(mesh=mesh, material=rubber)
    >>> newton = vv.Newton(linear=Petsc("-ksp_rtol 1e-8"))
    >>> system = vv.System([block, vv.Fixed(solid=block, nodes="x0")], newton=newton)
    >>> "PETSc" in system.linear_explanation
    True
    """

    options: str = ""

    is_shared = True

    def __post_init__(self) -> None:
        settings(self.options)

    def choose(self, problem: Problem) -> Choice:
        """Solvers for a problem."""
        problem = world().first(problem)  # each knows a part of it
        methods = []
        solid = problem.is_definite and problem.has_modes and not problem.n_multipliers
        if solid and problem.has_inertia:
            few = {"ksp_type": "cg", "pc_type": "pbjacobi", "ksp_rtol": LOOSE, "ksp_max_it": FEW}
            methods.append(("conjugate gradients with blocks of nodes", few))
        if solid or (problem.temperatures is Temperatures.ALONE and not problem.n_multipliers):
            to = {"ksp_rtol": "1e-6", "ksp_max_it": "200"}
            if not problem.nearly:
                methods.append(("conjugate gradients with multigrid", {"ksp_type": "cg", **MULTIGRID, **to}))
            methods.append(("GMRES with multigrid", {"ksp_type": "gmres", **MULTIGRID, **to}))
        given = settings(self.options)
        choices = [chosen(name, {**options, **given}) for name, options in methods]
        direct, by = factors(problem)
        text = "; should it not converge, ".join([*(name for name, _ in methods), by])
        return Choice((*choices, *direct), f"PETSc {version()}: {text}")


def chosen(name: str, options: dict[str, str]) -> _core.LinearChoice:
    """What the core is told."""
    return outside(partial(Solver, name, options))


def outside(make: Callable[[], Any]) -> _core.LinearChoice:
    """A solver that is made so."""
    choice = _core.LinearChoice()
    choice.backend = _core.Backend.outside
    choice.set_outside(make)
    return choice


def factors(problem: Problem) -> tuple[list[_core.LinearChoice], str]:
    """Factors by a package that PETSc was built with, else by those of the core in the first process."""
    name = next((name for name in FACTORS if PETSc.Sys.hasExternalPackage(name)), "")
    if name:
        options = {"pc_type": "lu", "pc_factor_mat_solver_type": name, **REFINED}
        return [chosen(f"factors of {name}", options)], f"factors of {name}"
    direct = Direct().choose(problem)
    if world().size == 1:
        return list(direct.in_order), direct.explanation
    return [outside(partial(Gathered, direct.in_order))], "factors in the first process"


def settings(options: str) -> dict[str, str]:
    """Names and values of options as PETSc writes them.

    Raises
    ------
    InputError
    """
    found: dict[str, str] = {}
    name = ""
    for word in shlex.split(options):
        if word.startswith("-") and not is_number(word):
            name = word.removeprefix("-")
            found[name] = ""
        elif name and not found[name]:
            found[name] = word
        else:
            raise InputError(f"options of PETSc {options!r}: {word!r} belongs to no -name")
    return found


def is_number(word: str) -> bool:
    """Whether a word is one."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def version() -> str:
    """Version of PETSc."""
    return ".".join(map(str, PETSc.Sys.getVersion()))


def refuse_unfit() -> None:
    """Refuse a PETSc of other numbers.

    Raises
    ------
    InputError
    """
    if np.dtype(PETSc.ScalarType) != np.float64:
        raise InputError(
            f"PETSc was built with numbers of type {np.dtype(PETSc.ScalarType)}; visviva needs float64: build it "
            "without --with-scalar-type and --with-precision"
        )
