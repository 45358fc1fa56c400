"""Linear solvers of the Newton iteration: what to use, chosen by the problem or by the user.

Every choice names solvers in the order of preference: where one fails (a matrix that is not positive definite
after all, no convergence, not enough memory) the next takes over and says so.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import sys
from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.arguments import Validated, bounded
from visviva.base.errors import InputError

Array = NDArray[np.float64]
Ints = NDArray[Any]

BETWEEN = 1e-300, 1 - 1e-9
"""Tolerances of iterative solvers."""

SMALL = 3000
"""Up to this many equations Eigen's sparse LU, which is always there, is as fast as PARDISO."""

SMALL_WIDE, WIDE_ROWS = 300, 80
"""The same, where rows have more entries than that: of quadratic hexahedra Eigen's LU costs ten times PARDISO's."""

TINY = 10_000
"""Up to this many entries factors are cheaper than iterations, however short the time step."""

DENSE_ROWS = 40
"""Rows with more entries than this belong to a three-dimensional mesh, whose factors fill."""

DENSE_ROWS_OF_HEAT = 12
"""The same for temperatures, one to a node."""

DENSE_ROWS_OF_FLOWS = 50
"""The same for velocities with pressures."""

LARGE_SOLID = 5000
"""From this many equations of a solid in space multigrid takes a half (plates, rods) to a sixth (cubes) of factors."""

LARGE = 15_000
"""From this many equations of a mesh in space iterations are as fast as factors in mixtures and in steps in contact."""

LARGE_FOR_EIGEN = 5000
"""The same, where the factors are Eigen's."""

GRIDS = ("multigrid", "augmented", "mixture")
"""Preconditioners that need multigrid."""

FEW, LOOSE = 100, 1e-3
"""Iterations that conjugate gradients may take at short steps, and their tolerance: Newton goes on anyway.
Beyond this, they cost more than their share of a factorisation that serves several of Newton's iterations."""

LOOSE_MIXTURE = 1e-2
"""Of GMRES in mixtures, whose tangents Newton keeps: 1e-3 spares it one iteration in thirty, and takes longer."""

LINEAR = 1e-8
"""Tolerance of iterations for equations that are linear: they are solved once in a step."""

FEW_SADDLE = 40
"""The same of GMRES with contact pressures."""

PRESSED, CLOSE = 5000, 3e-5
"""From this many equations of a three-dimensional mesh GMRES with multigrid is faster than factors where pressures of
contact stand beside them in statics, and its tolerance: hardly an iteration more of Newton's."""


FLOW_REGULARIZATION = 1e-8  # of pressures, in a matrix with entries of unit size
LARGE_FLOW, CLOSE_FLOW = 6000, 1e-3
"""From this many equations of a flow in space GMRES is faster than factors; its tolerance: Newton goes on anyway."""


class Temperatures(Enum):
    """Temperatures among the equations.

    Attributes
    ----------
    NONE, ALONE, COUPLED
        ALONE: one to a node, and nothing else; COUPLED: with entropies and what deforms.
    """

    NONE = "none"
    ALONE = "alone"
    COUPLED = "coupled"


@dataclass(frozen=True)
class Problem:
    """Facts about a system on which the choice depends.

    Parameters
    ----------
    n, n_entries : int
        Equations, and entries of the tangent's pattern.
    symmetric : bool
        The tangent is symmetric.
    nearly : bool
        Symmetric but for terms that vanish with the length of the step, as under discrete gradients; exactly so
        where strains are small.
    definite : bool
        It is expected to be positive definite as well (statics and dynamics of stable solids).
    n_multipliers : int
        Constraints among the equations; they make the matrix indefinite.
    has_modes : bool
        Rigid-body modes are known, so multigrid is effective.
    n_pressures : int
        Unknowns without inertia that are no constraints of joints: pressures of contact.
    has_inertia : bool
        The tangent is that of a time step: where steps are short, mass outweighs stiffness.
    regularization : float
        Taken off the scaled diagonal of redundant constraints.
    has_diagonal : bool
        Of unsymmetric tangents: no entry of the diagonal vanishes.
    has_flow : bool
        Velocities and pressures of a fluid are among the equations; solids that it carries along have left them.
    is_flow : bool
        Nothing else is: all constraints are pressures.
    temperatures : Temperatures
        Whether there are some, and what else.
    separates : bool
        Contents and their chemical potentials are among the equations.
    n_condensed : int
        Pressures of contact that have left the equations; they leave them unsymmetric.
    """

    n: int
    n_entries: int
    symmetric: bool = False
    nearly: bool = False
    definite: bool = False
    n_multipliers: int = 0
    has_modes: bool = False
    n_pressures: int = 0
    has_inertia: bool = False
    regularization: float = 0.0
    has_diagonal: bool = False
    has_flow: bool = False
    is_flow: bool = False
    temperatures: Temperatures = Temperatures.NONE
    separates: bool = False
    n_condensed: int = 0

    @property
    def kind(self) -> _core.MatrixKind:
        """Kind of the matrix."""
        if not self.symmetric or self.n_condensed:
            return _core.MatrixKind.general
        definite = self.definite and self.n_multipliers == 0
        return _core.MatrixKind.definite if definite else _core.MatrixKind.symmetric

    @property
    def is_definite(self) -> bool:
        """Symmetric, positive definite and without constraints."""
        return self.kind == _core.MatrixKind.definite

    @property
    def is_solid(self) -> bool:
        """A positive definite tangent with the pattern of a three-dimensional mesh."""
        if self.temperatures is Temperatures.ALONE:
            return self.is_definite and self.n_entries > DENSE_ROWS_OF_HEAT * self.n
        return self.is_definite and self.has_modes and self.n_entries > DENSE_ROWS * self.n

    @property
    def is_contact(self) -> bool:
        """Symmetric, with pressures of contact, condensed or not, and no other constraints."""
        return self.symmetric and self.n_pressures + self.n_condensed > 0 and self.n_multipliers == 0

    @property
    def is_pressed(self) -> bool:
        """The static tangent of a three-dimensional mesh with contact pressures."""
        large = self.n >= PRESSED and self.n_entries > DENSE_ROWS * self.n
        return self.is_contact and large and not self.has_inertia and not self.n_condensed

    @property
    def is_large_impact(self) -> bool:
        """A time step of a large three-dimensional mesh in contact, which costs less in halves than by factors."""
        large = self.n >= LARGE and self.n_entries > DENSE_ROWS * self.n
        return self.is_contact and large and self.has_inertia

    @property
    def is_large_flow(self) -> bool:
        """A flow in space whose factors fill."""
        return self.has_flow and self.n >= LARGE_FLOW and self.n_entries > DENSE_ROWS_OF_FLOWS * self.n

    @property
    def is_plane_flow(self) -> bool:
        """The unsymmetric tangent of a plane mesh whose pattern tells the pivots: minimum degree orders it best."""
        return (
            self.has_diagonal
            and self.kind == _core.MatrixKind.general
            and self.n_entries <= DENSE_ROWS * self.n
        )

    @property
    def is_small(self) -> bool:
        """Eigen's factors are as fast as PARDISO's."""
        return self.n <= (SMALL_WIDE if self.n_entries > WIDE_ROWS * self.n else SMALL)

    def __str__(self) -> str:
        kind = {"definite": "symmetric positive definite", "symmetric": "symmetric", "general": "unsymmetric"}
        text = f"{self.n} equations with {self.n_entries / max(self.n, 1):.0f} entries each, "
        text += kind[self.kind.name] + (" but for terms of the step's length" if self.nearly else "")
        text += f", {self.n_multipliers} constraints" if self.n_multipliers else ""
        return text + (f", {self.n_condensed} pressures condensed" if self.n_condensed else "")


def is_heated_solid(problem: Problem) -> bool:
    """Whether positions, entropies and temperatures on a three-dimensional mesh are unknown, without constraints."""
    others = problem.n_multipliers + problem.n_pressures + problem.n_condensed
    wide = problem.n_entries > DENSE_ROWS * problem.n
    return problem.temperatures is Temperatures.COUPLED and wide and not others


@dataclass(frozen=True)
class Choice:
    """Solvers in the order of preference, and the reason.

    Parameters
    ----------
    in_order : tuple
        What the core is told.
    explanation : str
        Why these.
    """

    in_order: tuple[_core.LinearChoice, ...]
    explanation: str


class LinearOptions(metaclass=Validated):
    """Choice of the linear solver; `Automatic`, `Direct`, `Iterative`, `Staggered` or `Petsc`."""

    @abstractmethod
    def choose(self, problem: Problem) -> Choice:
        """Solvers for a problem."""


@dataclass(frozen=True)
class Direct(LinearOptions):
    """Factorise the tangent.

    Parameters
    ----------
    library : {"auto", "pardiso", "eigen"}
        PARDISO of oneMKL (``pip install visviva[mkl]``) or Eigen, which is always there; "auto" takes PARDISO
        for more than a few thousand equations, or a few hundred of quadratic hexahedra, if it is installed.
    memory_limit : float
        Factors estimated to need more bytes are refused; 0 means what the machine has available.

    Examples
    --------
    >>> import visviva as vv
    >>> print(vv.Direct(library="eigen").choose(vv.linear.choice.Problem(n=100, n_entries=700)).explanation)
    100 equations with 7 entries each, unsymmetric: sparse LU of Eigen
    """

    library: Literal["auto", "pardiso", "eigen"] = "auto"
    memory_limit: float = 0.0

    def __post_init__(self) -> None:
        bounded(self, memory_limit=(0.0, 1e300))

    def choose(self, problem: Problem) -> Choice:
        """Solvers for a problem."""
        missing = missing_pardiso()
        if self.library == "pardiso" and missing:
            raise InputError(f"PARDISO cannot be used: {missing}. Install it with pip install visviva[mkl]")
        small = self.library == "auto" and problem.is_small
        if self.library == "eigen" or small or missing:
            return self._eigen(problem, missing if self.library == "auto" and not small else "")
        return self._pardiso(problem)

    def _eigen(self, problem: Problem, missing: str) -> Choice:
        lu = self._core(problem, _core.Backend.sparse_lu, _core.MatrixKind.general)
        because = f" (PARDISO is missing: {missing})" if missing else ""
        if not problem.is_definite:
            return Choice((lu,), f"{problem}: sparse LU of Eigen{because}")
        first = self._core(problem, _core.Backend.cholesky, problem.kind)
        text = (
            "Cholesky factors by Eigen, or sparse LU where the tangent is not symmetric and positive definite"
        )
        return Choice((first, lu), f"{problem}: {text}{because}")

    def _pardiso(self, problem: Problem) -> Choice:
        kinds = [_core.MatrixKind.definite, _core.MatrixKind.symmetric, _core.MatrixKind.general]
        kinds = kinds[kinds.index(problem.kind) :]
        if problem.nearly:  # what is not symmetric enough for the first factors is not so for the second
            kinds = [kinds[0], kinds[-1]]
        words = {
            "definite": "Cholesky",
            "symmetric": "symmetric indefinite factors",
            "general": "LU",
        }
        choices = tuple(self._core(problem, _core.Backend.pardiso, k) for k in kinds)
        text = ", or where that fails ".join(words[k.name] for k in kinds)
        return Choice(choices, f"{problem}: PARDISO of oneMKL with {text}")

    def _core(self, problem: Problem, backend: Any, kind: Any) -> _core.LinearChoice:
        c = _core.LinearChoice()
        c.backend, c.kind, c.regularization = backend, kind, problem.regularization
        c.library, c.memory_limit = mkl_library(), self.memory_limit
        c.matching, c.minimum_degree = not problem.has_diagonal, problem.is_plane_flow
        if problem.is_flow and kind == _core.MatrixKind.general and backend == _core.Backend.pardiso:
            # Velocities are definite, so pressures have pivots of one sign once their diagonal has: nothing is matched
            # anew for every tangent. Newton's iteration makes up for what little that changes.
            c.matching, c.regularization = False, max(problem.regularization, FLOW_REGULARIZATION)
        return c


@dataclass(frozen=True)
class Iterative(LinearOptions):
    """Solve by a Krylov method; a solution that misses the tolerance fails the step.

    Parameters
    ----------
    method : {"auto", "cg", "gmres", "bicgstab"}
        "auto": conjugate gradients for symmetric positive definite tangents, else GMRES.
    preconditioner : {"auto", "none", "diagonal", "block", "incomplete", "multigrid", "saddle", "augmented", \
"commutator"}
        "block": the diagonal blocks of the nodes, best for small time steps; "saddle": the same, with constraints and
        pressures exactly, for contact; "augmented": multigrid beside pressures of contact, in statics; "commutator":
        flows, block triangular with incomplete factors of the velocities and the least-squares commutator of the
        pressures (SIMPLE where elements are stabilised), which from a few thousand pressures on is solved by a cycle of
        multigrid, if PyAMG is there, else by factors; "mixture": contents with their potentials, by a
        polynomial, in long steps by multigrid; "incomplete": block ILU(0); "multigrid": smoothed aggregation (``pip
        install visviva[amg]``), best for statics. "auto" takes multigrid where it can, else blocks.
    tolerance : float
        Of the residual, relative to the right-hand side; a tenth of the contraction of a kept tangent, if that is more.
    max_iterations, restart : int
        Limit of iterations, and length of a cycle of GMRES.

    Examples
    --------
    >>> import visviva as vv
    >>> vv.Iterative(preconditioner="block", tolerance=1e-8).max_iterations
    500
    """

    method: Literal["auto", "cg", "gmres", "bicgstab"] = "auto"
    preconditioner: Literal[
        "auto",
        "none",
        "diagonal",
        "block",
        "incomplete",
        "multigrid",
        "saddle",
        "augmented",
        "commutator",
        "mixture",
    ] = "auto"
    tolerance: float = 1e-6
    max_iterations: int = 500
    restart: int = 50

    def __post_init__(self) -> None:
        bounded(self, tolerance=BETWEEN, max_iterations=(1, 2**31 - 1), restart=(1, 2**31 - 1))

    def choose(self, problem: Problem) -> Choice:
        """Solvers for a problem."""
        exact = problem.is_definite and not problem.nearly
        method = self.method if self.method != "auto" else "cg" if exact else "gmres"
        fits = problem.n_multipliers == 0 and problem.has_modes
        auto = "multigrid" if fits and has_multigrid() else "block"
        preconditioner = self.preconditioner if self.preconditioner != "auto" else auto
        if preconditioner in GRIDS and not has_multigrid():
            raise InputError("multigrid needs PyAMG: pip install visviva[amg]")
        methods = ["cg", "gmres"] if method == "cg" and self.method == "auto" else [method]
        words = {"cg": "conjugate gradients", "gmres": "GMRES", "bicgstab": "BiCGStab"}
        text = ", or where that fails ".join(words[m] for m in methods)
        text = f"{problem}: {text} to {self.tolerance:g}, preconditioner {preconditioner}"
        return Choice(tuple(self._core(problem, m, preconditioner) for m in methods), text)

    def _core(self, problem: Problem, method: str, preconditioner: str) -> _core.LinearChoice:
        c = _core.LinearChoice()
        c.backend, c.kind = _core.Backend.krylov, problem.kind
        c.method = getattr(_core.KrylovMethod, method)
        c.preconditioner = getattr(_core.Preconditioner, preconditioner)
        c.tolerance, c.max_iterations, c.restart = self.tolerance, self.max_iterations, self.restart
        c.library = mkl_library()
        if preconditioner in GRIDS or (preconditioner == "commutator" and has_multigrid()):
            from visviva.linear.multigrid import aggregates

            c.set_aggregator(aggregates)
        return c


@dataclass(frozen=True)
class Automatic(LinearOptions):
    """Choose by size, kind of the matrix and what is installed.

    Large three-dimensional positive definite problems, heat too, are solved by conjugate gradients with multigrid and,
    should that fail, by factors, large flows in space by GMRES with the commutator of the pressures, large mixtures in
    space by GMRES with contents beside their potentials; everything else by factors. Time steps of large
    solids in contact whose iterative solver fails are cut in halves, three times, before factors are made. In time
    steps, conjugate gradients with the diagonal alone come first: where steps are short they need a few iterations
    only. They do so too under discrete gradients, the tangents of which are not quite symmetric: what is not is small
    beside the mass then, and the residual is looked at. Solids with temperatures take BiCGStab with the blocks
    of all unknowns of a node in their place. Where
    multigrid takes over, GMRES takes the place of conjugate gradients.

    Parameters
    ----------
    tolerance : float
        Of iterative solvers.
    """

    tolerance: float = 1e-6

    def __post_init__(self) -> None:
        bounded(self, tolerance=BETWEEN)

    def choose(self, problem: Problem) -> Choice:
        """Solvers for a problem."""
        direct = Direct().choose(problem)
        large = LARGE if not missing_pardiso() else LARGE_FOR_EIGEN
        first = []
        if problem.is_contact and problem.has_inertia:
            first.append(
                Iterative(method="gmres", preconditioner="saddle", tolerance=LOOSE, max_iterations=FEW_SADDLE)
            )
        if problem.is_large_flow:
            first.append(
                Iterative(
                    method="gmres",
                    preconditioner="commutator",
                    tolerance=CLOSE_FLOW,
                    max_iterations=300,
                    restart=100,
                )
            )
        separates = problem.separates and problem.n_entries > DENSE_ROWS * problem.n
        if separates and problem.n >= large and has_multigrid():
            first.append(
                Iterative(
                    method="gmres", preconditioner="mixture", tolerance=LOOSE_MIXTURE, max_iterations=FEW
                )
            )
        if problem.is_pressed and has_multigrid():
            first.append(
                Iterative(method="gmres", preconditioner="augmented", tolerance=CLOSE, max_iterations=100)
            )
        if problem.is_solid and problem.has_inertia and problem.temperatures is Temperatures.NONE:
            first.append(
                Iterative(method="cg", preconditioner="diagonal", tolerance=LOOSE, max_iterations=FEW)
            )
        if is_heated_solid(problem) and problem.has_inertia:
            first.append(
                Iterative(method="bicgstab", preconditioner="block", tolerance=LOOSE, max_iterations=FEW)
            )
        is_linear = problem.temperatures is Temperatures.ALONE  # then factors serve all steps of a length
        if problem.is_solid and problem.n >= (large if is_linear else LARGE_SOLID) and has_multigrid():
            limit = 100  # beyond it factors are cheaper
            method: Literal["cg", "gmres"] = "gmres" if problem.nearly else "cg"
            first.append(
                Iterative(
                    method=method,
                    preconditioner="multigrid",
                    tolerance=min(self.tolerance, LINEAR) if is_linear else self.tolerance,
                    max_iterations=limit,
                )
            )
        choices = [*(f.choose(problem) for f in first), direct]
        reasons = [str(problem), *(c.explanation.removeprefix(f"{problem}: ") for c in choices)]
        if problem.is_large_impact:
            for c in direct.in_order:
                c.last_resort = True
            reasons[-1] = f"in the shortest steps {reasons[-1]}"
        text = "; should it not converge, ".join(reasons[1:])
        return Choice(tuple(c for choice in choices for c in choice.in_order), f"{reasons[0]}: {text}")


def n_rigid_motions(dimension: int) -> int:
    """How many motions of points strain nothing."""
    return dimension + len(turns(dimension))


def turns(dimension: int) -> list[tuple[int, int]]:
    """Planes of the rotations."""
    return [(0, 1), (1, 2), (2, 0)] if dimension == 3 else [(0, 1)]


def put_rigid_motions(positions: Array, coordinates: Ints, motions: Array, rows: Ints) -> None:
    """Put motions of points (n, d) that strain nothing, of some of the n * d coordinates, into rows of zeros.

    Rotations are about the centre, so that all motions are of similar size.

    Examples
    --------
    >>> import numpy as np
    >>> motions = np.zeros((4, 3))
    >>> put_rigid_motions(np.array([[0.0, 0.0], [2.0, 0.0]]), np.arange(4), motions, np.arange(4))
    >>> motions.tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]]
    """
    d, centre = positions.shape[1], positions.mean(axis=0)
    node, direction = coordinates // d, coordinates % d
    motions[rows, direction] = 1.0
    for k, (i, j) in enumerate(turns(d)):
        for along, other, sign in ((i, j, -1.0), (j, i, 1.0)):
            some = direction == along
            arm = positions[node[some], other] - centre[other]
            motions[rows[some], d + k] = 0.0 + sign * arm


@cache
def mkl_library() -> str:
    """Path of oneMKL's single dynamic library; empty if it is not beside Python."""
    return next((str(p) for p in _mkl_places() if p.exists()), "")


def _mkl_places() -> Iterator[Path]:
    try:
        files = importlib.metadata.files("mkl") or []
    except importlib.metadata.PackageNotFoundError:
        files = []
    yield from (Path(os.path.normpath(f.locate())) for f in files if f.name.startswith("libmkl_rt.so"))
    yield from sorted((Path(sys.prefix) / "lib").glob("libmkl_rt.so*"))


@cache
def missing_pardiso() -> str:
    """Why PARDISO cannot be used; empty if it can."""
    return _core.missing_pardiso(mkl_library())


@cache
def has_multigrid() -> bool:
    """Whether PyAMG is installed."""
    return importlib.util.find_spec("pyamg") is not None
