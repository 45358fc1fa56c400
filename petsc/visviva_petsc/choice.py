"""Which solvers of PETSc solve the linear equations of a step."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from mpi4py import MPI  # noqa: F401  before PETSc, which may link to the MPI that comes with it
from petsc4py import PETSc

from visviva import _core
from visviva.base.errors import InputError
from visviva.base.world import world
from visviva.linear.choice import Automatic, Choice, Direct, LinearOptions, Problem, Temperatures
from visviva_petsc.flow import BESIDE, FlowSolver
from visviva_petsc.gathered import Gathered
from visviva_petsc.solver import Solver
from visviva_petsc.together import Together
from visviva_petsc.trial import refuse_loose, refuse_unknown

Options = dict[str, str]

MULTIGRID = {
    "pc_type": "gamg",
    "pc_gamg_threshold": "0.02",
    "mg_levels_ksp_type": "chebyshev",
    "mg_levels_pc_type": "jacobi",
}
"""Aggregates of nodes on the rigid motions of solids, smoothed."""
LARGE = 100_000
"""Equations of a process from which memory counts."""
LEAN = {
    **MULTIGRID,
    "pc_gamg_agg_nsmooths": "0",
    "pc_gamg_aggressive_square_graph": "0",
    "pc_mg_cycle_type": "w",
    "ksp_max_it": "400",
}
"""Aggregates as they are have a quarter of the entries, and their graph is not squared. They want coarse grids twice in
a cycle, and two to three times as many cycles, which cheaper products make up for."""
ALL_AT_ONCE = {"matptap_via": "allatonce"}
"""Of products in several processes: nothing is kept in between."""
CLOSE = {"ksp_rtol": "1e-6", "ksp_max_it": "200"}
LOOSE = {"ksp_rtol": "1e-3", "ksp_max_it": "100"}
"""Of conjugate gradients at short steps, where Newton goes on anyway."""
FACTORS = ("mumps", "superlu_dist")
"""Packages that factor what processes share, in the order of preference."""
REFINED = {"ksp_type": "gmres", "ksp_rtol": "1e-12", "ksp_max_it": "20"}
"""Iterations that make up for pivots that were moved."""


def choose(problem: Problem, given: Options) -> Choice:
    """Solvers for a problem; options of the user go before those of this module.

    Raises
    ------
    InputError
        If none of them takes an option, or one lets residuals be.
    """
    refuse_loose(given)
    problem = world().first(problem)  # each knows a part of it
    methods = methods_for(problem)
    if not methods and given.keys() & {"ksp_type", "pc_type"}:
        methods = [("what -ksp_type and -pc_type say", {"ksp_type": "gmres", **CLOSE})]
    if shared := next((name for name in FACTORS if PETSc.Sys.hasExternalPackage(name)), ""):
        options = {"pc_type": "lu", "pc_factor_mat_solver_type": shared, **REFINED}
        methods.append((f"factors of {shared}", options))
    methods = [(name, {**options, **given}) for name, options in methods]
    refuse_unknown(methods, given)
    choices, names = [chosen(*method) for method in methods], [name for name, _ in methods]
    if not shared:
        last = of_core(problem, Direct() if methods else Automatic())
        choices, names = [*choices, *last.in_order], [*names, last.explanation]
    text = "; should it not converge, ".join(names)
    if given:
        text += ", with " + " ".join(f"-{name} {value}".strip() for name, value in given.items())
    return Choice(tuple(choices), f"PETSc {version()}: {text}")


def methods_for(problem: Problem) -> list[tuple[str, Options]]:
    """Iterations that solve the equations in less than factors would, in their order."""
    methods: list[tuple[str, Options]] = []
    solid = problem.is_definite and problem.has_modes and not problem.n_multipliers
    if solid and problem.has_inertia:
        few = {"ksp_type": "cg", "pc_type": "pbjacobi", **LOOSE}
        methods.append(("conjugate gradients with blocks of nodes", few))
    if solid or (problem.temperatures is Temperatures.ALONE and not problem.n_multipliers):
        grids = lean() if solid and problem.n >= LARGE else MULTIGRID
        if not problem.nearly:
            few = {"mg_levels_esteig_ksp_type": "cg"}  # vectors that estimates of eigenvalues keep
            methods.append(
                ("conjugate gradients with multigrid", {"ksp_type": "cg", **CLOSE, **few, **grids})
            )
        methods.append(("GMRES with multigrid", {"ksp_type": "gmres", **CLOSE, **grids}))
    if problem.is_flow and problem.is_large_flow:
        methods.append(("GMRES with velocities and pressures in turn", BESIDE))
    return methods


def lean() -> Options:
    """Multigrid of solids that are large."""
    return {**LEAN, **ALL_AT_ONCE} if world().size > 1 else LEAN


def chosen(name: str, options: Options) -> _core.LinearChoice:
    """What the core is told."""
    kind = FlowSolver if options.get("pc_type") == "fieldsplit" else Solver
    return outside(partial(kind, name, options))


def outside(make: Callable[[], Any]) -> _core.LinearChoice:
    """A solver that is made so."""
    choice = _core.LinearChoice()
    choice.backend = _core.Backend.outside
    choice.set_outside(lambda: Together(make()))
    return choice


def of_core(problem: Problem, options: LinearOptions) -> Choice:
    """What the core solves by in one process; of several processes in the first."""
    own = options.choose(problem)
    if world().size == 1:
        return own
    choices = []
    for by in own.in_order:
        choices.append(outside(partial(Gathered, by)))
        choices[-1].last_resort = by.last_resort
    return Choice(tuple(choices), f"in the first process {own.explanation}")


def version() -> str:
    """Version of PETSc."""
    return ".".join(map(str, PETSc.Sys.getVersion()))


def refuse_unfit() -> None:
    """Refuse a PETSc of other numbers, or too old.

    Raises
    ------
    InputError
    """
    if np.dtype(PETSc.ScalarType) != np.float64:
        raise InputError(
            f"PETSc was built with numbers of type {np.dtype(PETSc.ScalarType)}; visviva needs float64: build it "
            "without --with-scalar-type and --with-precision"
        )
    if not hasattr(PETSc.Mat, "setPreallocationCOO"):
        raise InputError(
            f"petsc4py {version()} is too old, it has no Mat.setPreallocationCOO, by which those are known that serve; "
            "install a newer one and its PETSc, as docs/howto/many_processes.rst says"
        )
