"""Options that no solver takes, found before the first step by solving something small with each of them."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from visviva.base.errors import InputError
from visviva_petsc.together import told

N = 6
"""Nodes along the side of a cube, enough for two levels of multigrid."""
PREFIX = "visviva_trial_"
SHOWS = re.compile("view|monitor|reason")
LEVEL = re.compile(r"^mg_levels_\d+_")


def refuse_unknown(methods: Sequence[tuple[str, dict[str, str]]], given: dict[str, str]) -> None:
    """Refuse options of the user that none of the methods takes.

    Raises
    ------
    InputError
    """
    if not given:
        return
    taken = {name for _, options in methods for name in taken_of(options, given)}
    if left := [name for name in given if name not in taken]:
        names, by = ", ".join(f"-{name}" for name in left), "; ".join(name for name, _ in methods)
        raise InputError(
            f"options of PETSc: no solver here takes {names} (here are: {by or 'factors of the core alone'}). Look at "
            "the spelling; -ksp_type and -pc_type choose other solvers, and options of the whole of PETSc, such as "
            "-log_view, go into the environment: PETSC_OPTIONS"
        )


def refuse_loose(given: dict[str, str]) -> None:
    """Refuse options by which a solver may leave all of a residual: increments of nothing are taken for convergence.

    Raises
    ------
    InputError
    """
    if left := [f"-{name}" for name in ("ksp_atol", "ksp_convergence_test") if name in given]:
        raise InputError(
            f"options of PETSc: by {', '.join(left)} a solver may end where it begins, and Newton's method would take "
            "that for a step that needs no increment: say by -ksp_rtol what share of a residual may be left"
        )


def taken_of(options: dict[str, str], given: dict[str, str]) -> set[str]:
    """Those of the user's options that a solver asks for."""
    named = {name: LEVEL.sub("mg_levels_1_", name) for name in options}
    database = PETSc.Options()
    for name, value in options.items():
        quiet = "ascii:/dev/null" if SHOWS.search(name) and name in given else value
        database.setValue(PREFIX + named[name], quiet or None)
    try:
        is_solved = solves()
        return {n for n in given if not is_solved or database.used(PREFIX + named[n])}
    finally:
        for name in named.values():
            database.delValue(PREFIX + name)


def solves() -> bool:
    """Solve something small by the options; whether they suit it, else which of them PETSc takes cannot be told."""
    A, ksp = cube(), PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setOptionsPrefix(PREFIX)
    ksp.setOperators(A)
    right, solution = A.createVecs()
    right.set(1.0)
    try:
        ksp.setFromOptions()
        if ksp.getPC().getType() == "fieldsplit":
            ksp.getPC().setFieldSplitFields(3, ("velocity", [0, 1]), ("pressure", [2]))
    except PETSc.Error as error:
        raise InputError(f"options of PETSc: {told(error)}") from None
    else:
        return is_done(ksp, right, solution)
    finally:
        for thing in (ksp, A, right, solution):
            thing.destroy()


def is_done(ksp: PETSc.KSP, right: PETSc.Vec, solution: PETSc.Vec) -> bool:
    """Whether a solver gets through."""
    try:
        ksp.solve(right, solution)
    except PETSc.Error:
        return False
    return True


def cube() -> PETSc.Mat:
    """Three numbers at each node of a cube, which neighbours pull towards theirs."""
    one, line = sp.eye(N), sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(N, N))
    pairs = [(line, one, one), (one, line, one), (one, one, line)]
    laplace = sum(sp.kron(sp.kron(a, b), c) for a, b, c in pairs)
    K = sp.kron(laplace, np.eye(3)).tocsr()
    rows, columns = K.indptr.astype(PETSc.IntType), K.indices.astype(PETSc.IntType)
    A = PETSc.Mat().createAIJ(K.shape, bsize=3, csr=(rows, columns, K.data), comm=PETSc.COMM_SELF)
    A.assemble()
    return A
