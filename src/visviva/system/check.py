"""Checks before the first step: freedoms, redundant constraints, initial state, tangents."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.base.html import table
from visviva.base.world import announce, world
from visviva.component.point import Attachable
from visviva.scheme.schemes import EnergyMomentum
from visviva.system.consistency import (
    Correction,
    descend,
    follow_branch,
    project_positions,
    project_velocities,
    rate_violation,
    worst,
)
from visviva.system.freedom import refuse_undetermined
from visviva.system.instant import COMPLIANCE, Instant, instant
from visviva.system.memory import returning

if TYPE_CHECKING:
    from visviva.model.field import Field
    from visviva.system.system import System

Array = NDArray[np.float64]

TANGENT_TOLERANCE = 1e-5
"""A tangent that differs from differences by more than this, relative to its row and column, is reported."""
WAYS = (1e-5, 1e-6, 1e-7)
"""Lengths of differences, as parts of the unknown's size. Contact of small areas bends much and has kinks within long
ones: a tangent is wrong where shorter ones say so too."""


FAR = 1e-3
"""Part of the system's size (of its greatest given speed) by which an initial state is moved at most without a word of
the user."""
SHOWN = 6  # moves in a message


@dataclass
class Redundancy:
    """A constraint that follows from others.

    Attributes
    ----------
    component, constraint : str
        Whose it is, and which of its constraints.
    loop : list of str
        Components that the dependence runs through.
    """

    component: str
    constraint: str
    loop: list[str]

    def __str__(self) -> str:
        others = [label for label in self.loop if label != self.component]
        listed = ", ".join(others[:8]) + (f" and {len(others) - 8} more" if len(others) > 8 else "")
        return f"{self.constraint} of {self.component} follows from {listed or 'its others, or from what is held'}"


@dataclass
class TangentError:
    """The entry of the tangent that differs most from differences of the residual."""

    error: float
    row: str
    column: str
    entries: tuple[float, float]

    def __str__(self) -> str:
        if self.error <= TANGENT_TOLERANCE:
            return f"agree with differences to {self.error:.1e}"
        ours, theirs = self.entries
        return f"WRONG: d({self.row}) / d({self.column}) is {ours:.6g}, differences give {theirs:.6g}"


@dataclass
class CheckReport:
    """Findings of `System.check`; print it.

    Attributes
    ----------
    n_coordinates, n_constraints : int
        Unknown coordinates n and constraints m.
    degrees_of_freedom : int
        ``n - rank G`` in the initial configuration.
    redundant : list of Redundancy
        Constraints that follow from others; such systems are solved, their reactions are not unique.
    positions, velocities : Correction
        How the initial state was made consistent.
    moves : list of str
        What did not fit before the first step and was moved, in words; flows apart. Damage that grew into balance too,
        and temperatures that were evened out across ties.
    tangent : TangentError or None
        Worst entry of the tangent; None if it was not compared.
    remarks : list of str
        What components say about their accuracy.
    """

    n_components: int
    n_coordinates: int
    n_constraints: int
    degrees_of_freedom: int
    redundant: list[Redundancy]
    positions: Correction
    velocities: Correction
    tangent: TangentError | None = None
    remarks: list[str] = field(default_factory=list)
    moves: list[str] = field(default_factory=list)
    null_vectors: Array = field(default_factory=lambda: np.zeros((0, 0)), repr=False)

    def __repr__(self) -> str:
        return (
            f"CheckReport(n = {self.n_coordinates}, m = {self.n_constraints}, {self.degrees_of_freedom} degrees of "
            f"freedom, {len(self.redundant)} redundant constraints)"
        )

    def _repr_html_(self) -> str:
        first, *others = str(self).splitlines()
        return table([(line.strip(),) for line in others], title=first)

    @property
    def counted_freedoms(self) -> int:
        """Degrees of freedom by counting (Gruebler), blind to redundancy."""
        return self.n_coordinates - self.n_constraints

    def __str__(self) -> str:
        n, m = self.n_coordinates, self.n_constraints
        lines = [
            f"check of {self.n_components} components",
            f"  unknown coordinates n = {n}, constraints m = {m}, n - m = {self.counted_freedoms}",
            f"  degrees of freedom in the initial configuration {self.degrees_of_freedom}, "
            f"redundant constraints {len(self.redundant)}",
            *(f"    {r}" for r in self.redundant[:12]),
            f"  initial positions  {self.positions}",
            f"  initial velocities {self.velocities}",
        ]
        if self.tangent is not None:
            lines.append(f"  tangents {self.tangent}")
        lines += [f"  {remark}" for remark in self.remarks]
        return "\n".join(lines)


def check(system: System, *, repair: bool = True, tangents: bool = True) -> CheckReport:
    """Look a system over before its first step.

    Parameters
    ----------
    repair : bool
        Project the initial state onto the constraints; otherwise only tell what is violated. `System.check` repairs
        states that were given, and leaves those of steps alone.
    tangents : bool
        Compare tangents with differences (of a sample of columns in large systems).

    Returns
    -------
    CheckReport
        Degrees of freedom, redundant constraints by name, corrections of the state, worst tangent entry.

    Raises
    ------
    InputError
        If no configuration or no velocities satisfy the constraints, or if a massless coordinate is held by
        nothing; the message names components and unknowns.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    >>> rod = vv.Distance(a=ground.point(), b=ball.point())
    >>> vv.System([ground, ball, rod]).check().degrees_of_freedom
    2
    """
    refuse_undetermined(system)
    if world().size > 1 and not tangents and is_free(system):  # which spares them the whole matrix of masses
        return report_of_free(system)
    at = Instant(system)
    refuse_unheld(system, at)
    positions = project_positions(system, at) if repair else told(worst(at))
    if positions.moved:
        for component in system.components:
            component.follow_start(system)
        at = Instant(system)
    if len(at.multipliers):
        at.factor()
    null = at.redundancies()
    passing = null.shape[1] > 0 and settle(system, at) != null.shape[1]
    velocities = project_velocities(system, at) if repair else told(rate_violation(system, at))
    if repair and passing:
        velocities.moved |= follow_branch(system, at, null)
    report = CheckReport(
        n_components=len(system.components),
        n_coordinates=system.n_coordinates,
        n_constraints=system.n_constraints,
        degrees_of_freedom=system.n_coordinates - system.n_constraints + null.shape[1],
        redundant=redundancies(system, at, null),
        positions=positions,
        velocities=velocities,
        remarks=[remark for component in system.components for remark in component.remarks()],
        null_vectors=null,
    )
    if tangents and len(system.free_unknowns):
        report.tangent = compare_tangent(system)
    system.core.invalidate()
    return report


def is_free(system: System) -> bool:
    """Whether nodes of meshes are all that moves, and no constraints act on them: any state fits."""
    fields = system.model.fields
    return all(f.node > 1 or f.order == 0 for f in fields) and not any(f.multiplier for f in fields)


def report_of_free(system: System) -> CheckReport:
    """The report of a system that is free."""
    system.core.invalidate()
    return CheckReport(
        n_components=len(system.components),
        n_coordinates=system.n_coordinates,
        n_constraints=0,
        degrees_of_freedom=system.n_coordinates,
        redundant=[],
        positions=told(0.0),
        velocities=told(0.0),
        remarks=[remark for component in system.components for remark in component.remarks()],
        null_vectors=np.zeros((0, 0)),
    )


def fit(system: System, *, project: bool = False, moving: bool = True) -> CheckReport:
    """Check a system before its first step, and tell what of its initial state was moved onto the constraints.

    Of what is not `moving`, velocities mean nothing.

    Raises
    ------
    InputError
        If positions move by more than a thousandth of the size of the system, or speeds that were given change by as
        much of the greatest, unless `project` accepts that; the state is then as it was.
    """
    x, v, edited = system.x.copy(), system.v.copy(), system.stepper.is_edited
    report = check(system, tangents=False)
    if not moving:
        system.v[:] = v
    report.moves, far = told_moves(system, x, v, edited)
    if far and not project:
        system.x[:], system.v[:] = x, v
        system.core.invalidate()
        raise InputError(
            f"the initial state does not fit the constraints and would be moved far: {'; '.join(far[:SHOWN])}; give "
            "one that fits, or accept what it is moved to with project=True (--project)"
        )
    if report.moves:
        moved = "; ".join(report.moves[:SHOWN])
        announce(f"initial state moved onto the constraints: {moved}")
    return report


def told_moves(system: System, x0: Array, v0: Array, edited: bool) -> tuple[list[str], list[str]]:
    """Components that moved from a state by more than rounding, and those of them that moved far.

    Bodies at rest take the speeds that their joints give them; those of an `edited` state are all given.
    """
    moves, far = [], []
    dx, dv = np.abs(system.x - x0), np.abs(system.v - v0)
    inverse = np.where(system.order == 2, system.inverse_scale, 0.0)
    fastest = float(np.abs(v0 * inverse).max(initial=0.0)) if system.has_inertia else 0.0
    for f in system.model.fields:
        if f.order != 2 or not isinstance(f.component, Attachable):
            continue
        of = slice(f.start, f.start + f.size)
        given = system.has_inertia and (f.moves or (edited and bool(np.any(v0[of]))))
        for what, change, size, counts in (("position", dx, 1.0, True), ("velocity", dv, fastest, given)):
            part = float((change[of] * inverse[of]).max(initial=0.0)) / (size or 1.0)
            if part > 1e-9:
                moves.append(largest_move(system, f, what, change))
                if counts and part > FAR:
                    far.append(moves[-1])
    return moves, far


def largest_move(system: System, f: Field, what: str, change: Array) -> str:
    """Text on how far a field has moved: lengths, unless it hardly does but turn."""
    vectors = f.component.vectors(system.model)
    assert vectors is not None
    starts, is_position, width = vectors
    places = (starts[is_position][:, None] + np.arange(width)).ravel()
    places = np.intersect1d(places, f.unknowns)
    turns = np.setdiff1d(f.unknowns, places)
    parts = [float((change[u] * system.inverse_scale[u]).max(initial=0.0)) for u in (places, turns)]
    shown, of = (places, "") if 10 * parts[0] >= parts[1] else (turns, "directors' ")
    return f"{of}{what} of {f.component.label} by {change[shown].max():.3g}"


def told(violation: float) -> Correction:
    """The report of a violation that was left as it is."""
    return Correction(violation, violation, {})


# --- redundancy ---------------------------------------------------------------------------------------------


def redundancies(system: System, at: Instant, null: Array) -> list[Redundancy]:
    """One constraint for each null vector, of late components, without which the rest is independent."""

    import scipy.linalg as sla

    if null.shape[1] == 0:
        return []
    fields = {u: f for f in system.model.fields for u in f.unknowns if f.multiplier}
    owners = [fields[int(u)] for u in at.multipliers]
    candidates = np.array([k for k, f in enumerate(owners) if f.stage > 0], dtype=int)
    place = {id(c): k for k, c in enumerate(system.components)}
    weight = 1 + np.array([place[id(owners[k].component)] for k in candidates], dtype=float)
    _, _, order = sla.qr(null[candidates].T * weight, mode="economic", pivoting=True)
    found = []
    for k in sorted(int(candidates[j]) for j in order[: null.shape[1]]):
        mine = np.abs(null) @ np.abs(null[k])
        loop = [
            owners[j].component.label for j in np.flatnonzero(mine > 1e-6 * mine.max()) if owners[j].stage > 0
        ]
        f = owners[k]
        which = f"{f.name}[{int(at.multipliers[k]) - f.start}]"
        found.append(Redundancy(f.component.label, which, list(dict.fromkeys(loop))))
    return found


def settle(system: System, at: Instant) -> int:
    """Tell the solver where constraints are redundant, if they are so in a neighbouring configuration as
    well; returns how many are. What is undisturbed is not told.

    In a singular configuration (bars in one line) constraints depend on each other for an instant only and
    have to be kept; where they depend on each other all along, the solver leaves the multipliers out that
    have no effect.
    """
    random, lasting = np.random.default_rng(2), 0
    way, _ = at.solve(at.metric @ random.standard_normal(len(at.coordinates)), np.zeros(len(at.multipliers)))
    with returning(system):
        system.x[at.coordinates] += 0.05 * way / max(float(np.abs(way / at.scale).max()), 1e-9)
        system.x[at.multipliers] = 0.0
        if descend(system, damped=False) <= 1e-11:
            near = Instant(system)
            near.factor()
            step = instant(system.time, leading=1.0)
            lasting = near.redundancies().shape[1]
            if not system.is_undisturbed:
                tell_redundant(system, step, lasting)
    return lasting


def tell_redundant(system: System, step: Any, lasting: int) -> None:
    """Have the solver find redundant constraints where it finds as many as there are."""
    if system.core.find_redundant(step, system.signals(step), True) != lasting:
        system.core.find_redundant(step, system.signals(step), False)


# --- coordinates that nothing holds -------------------------------------------------------------------------


def refuse_unheld(system: System, at: Instant) -> None:
    """Refuse coordinates that neither inertia, nor a constraint, nor a stiffness or damping determines.

    Nodes of meshes are held by their elements; whether the whole is, statics finds out.
    """

    import scipy.sparse as sp
    import scipy.sparse.linalg as spl

    alone = np.ones(len(system.x), dtype=bool)
    for f in system.model.fields:
        alone[f.start : f.start + f.size] = f.node == 1
    own = np.flatnonzero(alone[at.coordinates])
    massless = own[abs(at.M[own]).sum(axis=1) == 0]
    if len(massless) == 0:
        return
    A = system.tangent(EnergyMomentum().step(system.time, 1.0))[1][:, at._q[massless]]
    A = sp.diags_array(1 / np.maximum(abs(A).max(axis=1).toarray().ravel(), 1e-300)) @ A
    normal = (A.T @ A).tocsc()
    lu = spl.splu(normal + COMPLIANCE * sp.eye_array(len(massless), format="csc"))
    z = np.random.default_rng(0).standard_normal(len(massless))
    for _ in range(3):
        z = lu.solve(z / np.linalg.norm(z))
    if np.linalg.norm(z) < 0.5 / COMPLIANCE:
        return
    loose = int(np.argmax(np.abs(z)))
    component, unknown = system.describe(int(at.coordinates[massless[loose]]))
    raise InputError(
        f"{unknown} of {component} has no inertia and no constraint or stiffness holds it: the equations are "
        "singular. Give its component mass, tie it by a joint, or leave it out"
    )


# --- tangents -----------------------------------------------------------------------------------------------


def compare_tangent(system: System, most: int = 150) -> TangentError:
    """Compare the default scheme's tangent with differences of its residual, off the initial state."""
    random, unknown = np.random.default_rng(1), system.free_unknowns
    step = EnergyMomentum().step(system.time, natural_time(system))
    sizes = unknowns_sizes(system, step)
    with returning(system):
        system.core.dx[unknown] = 1e-3 * random.standard_normal(len(unknown)) * sizes
        return worst_entry(system, step, sizes, random, most)


def worst_entry(
    system: System, step: Any, sizes: Array, random: np.random.Generator, most: int
) -> TangentError:
    """The same at the trial state, over parts of the unknowns' `sizes` (n,)."""
    unknown = system.free_unknowns
    with exact_stress(system):
        _, A = system.tangent(step)
    columns = np.arange(len(unknown))
    if len(columns) > most:
        columns = np.sort(random.choice(columns, most, replace=False))
    B = A.tocsc()[:, columns].toarray()
    largest = abs(A).max(axis=1).toarray().ravel()
    size = np.sqrt(np.maximum(largest[:, None] * largest[columns][None, :], 1e-300))
    D, error = np.empty_like(B), np.empty_like(B)
    for j, (of, scale) in enumerate(zip(unknown[columns], sizes[columns], strict=True)):
        for part in WAYS:
            D[:, j] = column_by_differences(system, step, int(of), part * scale)[unknown]
            error[:, j] = np.abs(B[:, j] - D[:, j]) / size[:, j]
            if error[:, j].max() <= TANGENT_TOLERANCE:
                break
    i, j = (int(k) for k in np.unravel_index(int(np.argmax(error)), error.shape))
    row, column = (name(system, int(unknown[k])) for k in (i, columns[j]))
    return TangentError(float(error[i, j]), row, column, (float(B[i, j]), float(D[i, j])))


@contextmanager
def exact_stress(system: System) -> Iterator[None]:
    """Tangents of solids that take their stress from the start of the step, as these would be without that."""
    terms = [t for t in system.model.batches if isinstance(t, _core.SolidTerm) and t.start_stress]
    for term in terms:
        term.start_stress = False
    try:
        yield
    finally:
        for term in terms:
            term.start_stress = True


def natural_time(system: System) -> float:
    """Length of a step in which inertia does what stiffness and forces do, 1 where there is nothing of one of them."""
    unknown = system.free_unknowns
    moves = np.where(system.order == 2, system.scale, 0.0)[unknown]
    mass = system.tangent(instant(system.time, leading=1.0))[1]
    force, stiffness = system.tangent(instant(system.time, theta=1.0))
    inertia = float(np.abs(mass.diagonal()) @ moves**2)
    rest = float(np.abs(stiffness.diagonal()) @ moves**2 + np.abs(force[unknown]) @ moves)
    # what has the density of the fluid about it has no inertia of its own, but rounding
    rounding = 1e-12 * sum(c.total_mass for c in system.components) * float(moves.max(initial=0.0)) ** 2
    return math.sqrt(inertia / rest) if inertia > rounding and rest > 0 else 1.0


def unknowns_sizes(system: System, step: Any) -> Array:
    """By what free unknowns (n,) are changed: their scale; multipliers by forces whose work is that of others' changes.

    Where there are no such forces, by 1.
    """
    scale = system.scale[system.free_unknowns]
    A = abs(system.tangent(step)[1])
    work, along = float((A.diagonal() * scale**2).max(initial=0.0)), np.asarray(A.T @ scale)
    forces = np.divide(work, along, out=np.ones_like(along), where=(along > 0) & (work > 0))
    sizes: Array = np.where(scale > 0, scale, forces)
    return sizes


def column_by_differences(system: System, step: Any, unknown: int, d: float) -> Array:
    """Central differences of the residual by one unknown, over a length `d` of it on both sides."""
    dx = system.core.dx
    here = float(dx[unknown])
    ends = []
    for sign in (1.0, -1.0):
        dx[unknown] = here + sign * d
        ends.append(system.residual(step))
    dx[unknown] = here
    column: Array = (ends[0] - ends[1]) / (2 * d)
    return column


def name(system: System, unknown: int) -> str:
    """An unknown in words."""
    component, field_name = system.describe(unknown)
    return f"{field_name} of {component}"
