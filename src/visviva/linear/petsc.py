"""PETSc as the solver of linear equations; the distribution visviva-petsc brings it."""

from __future__ import annotations

import shlex
from dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.base.world import brought
from visviva.linear.choice import Choice, LinearOptions, Problem


@dataclass(frozen=True)
class Petsc(LinearOptions):
    """Solve by PETSc: in one process, or in all that share the system.

    Solids by conjugate gradients with aggregation multigrid (GAMG) on their rigid motions, in short time steps with
    blocks of nodes first; where that fails by GMRES with the same. Heat alone by multigrid as well. Large flows in
    space by GMRES with velocities and pressures in turn (fieldsplit). Everything else by factors of MUMPS or
    SuperLU_DIST, if PETSc was built with them, else in the first process by what one would choose. What several
    processes share is solved so if nothing else is said. Needs ``visviva-petsc``.

    Parameters
    ----------
    options : str
        Of PETSc, such as ``"-ksp_view -ksp_rtol 1e-8"``; they go before those that are chosen here. Where factors would
        be chosen, ``-ksp_type`` or ``-pc_type`` have the equations solved so.

    Raises
    ------
    InputError
        If a word belongs to no option, or, as soon as equations are known, if none of the solvers takes an option.

    Examples
    --------
    >>> import visviva as vv
    >>> newton = vv.Newton(linear=vv.Petsc("-ksp_rtol 1e-8"))
    """

    options: str = ""

    is_shared = True

    def __post_init__(self) -> None:
        settings(self.options)

    def choose(self, problem: Problem) -> Choice:
        """Solvers for a problem."""
        choice: Choice = brought("linear=Petsc(...)").choose(problem, settings(self.options))
        return choice


def settings(options: str) -> dict[str, str]:
    """Names and values of options as PETSc writes them.

    Raises
    ------
    InputError

    Examples
    --------
    >>> settings("-ksp_view -ksp_rtol 1e-8")
    {'ksp_view': '', 'ksp_rtol': '1e-8'}
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
