"""Rigid motions that nothing holds: what makes a structure unfit for statics, or for motion without mass."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.base.world import world
from visviva.body.mesh_body import MeshBody
from visviva.component.component import Component
from visviva.component.point import Attachable
from visviva.model.field import Role
from visviva.scheme.schemes import EnergyMomentum, Scheme, load_step
from visviva.system.instant import instant, refuse_infinite
from visviva.system.shared import square

if TYPE_CHECKING:
    from visviva.model.field import Field
    from visviva.system.system import System

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

PIECE = 2**14
"""Rows that are looked at together, where copies of all would be the most that a run ever holds."""
ROUNDING = 3e-12
"""A motion that meets less than this part of the stiffnesses that cancel in it is free."""
TINY = np.finfo(float).tiny
"""Stiffnesses below it are none: nothing can be divided by them."""
CLEAR = 1e-6
"""Distance from a translation or rotation along an axis up to which a free motion is called so."""
BALANCED = 1e-9
"""Part of its size by which a body without mass may be out of balance."""


@dataclass(frozen=True)
class Motions:
    """Rigid motions of a body, translations along and rotations about the three axes.

    Attributes
    ----------
    body : Attachable
    centre : array (3,)
        Rotations are about it.
    moves : array (n, 6)
        Change of the system's unknowns; the largest is 1, or all are zero where the body has no such motion.
    size : array (6,)
        What the changes were divided by.
    unknowns : array of int, (m, d)
        Of its vectors.
    """

    body: Attachable
    centre: Array
    moves: Array
    size: Array
    unknowns: Ints

    @property
    def possible(self) -> NDArray[np.bool_]:
        """Mask of the six motions (6,) that the body has."""
        return self.size > 0

    def turned(self, forces: Array) -> Array:
        """By what forces (n,) on all unknowns change (n, 6) that move along."""
        found, width = np.zeros((len(forces), 6)), self.unknowns.shape[1]
        own = np.pad(forces[self.unknowns], ((0, 0), (0, 3 - width)))
        for k, axis in enumerate(np.eye(3)):
            found[self.unknowns, 3 + k] = np.cross(axis, own)[:, :width]
        return found / np.where(self.possible, self.size, 1.0)

    def in_words(self, free: Array) -> str:
        """Names of the free motions, the span of the columns of `free` (6, k)."""
        u, s, _ = np.linalg.svd(free, full_matrices=False)
        span = u[:, s > CLEAR]
        along = [k for k in range(6) if 1 - np.linalg.norm(span[k]) < CLEAR]
        rest = span - np.eye(6)[:, along] @ span[along]
        translations, rotations = (", ".join("xyz"[k % 3] for k in along if k // 3 == j) for j in (0, 1))
        words = [f"translation along {translations}"] * bool(translations)
        words += [f"rotation about {rotations}"] * bool(rotations)
        return "; ".join([*words, *map(self._screw, simplest(rest).T)])

    def _screw(self, motion: Array) -> str:
        """A motion (6,) along no axis of space."""
        translation, rotation = motion[:3], motion[3:] / np.where(self.possible, self.size, 1.0)[3:]
        speed = float(np.linalg.norm(rotation))
        if speed < CLEAR * np.linalg.norm(translation) / (np.max(self.size[3:], initial=0.0) or 1.0):
            return f"translation along {_direction(translation)}"
        through = self.centre + np.cross(rotation, translation) / speed**2
        return f"rotation about the axis through {_listed(through)} along {_direction(rotation)}"


def refuse_undetermined(system: System) -> None:
    """Refuse multipliers of what cannot give way, as pressures of an incompressible solid held throughout."""
    own: dict[int, list[Field]] = {}
    for f in system.model.fields:
        if f.order > 0:
            own.setdefault(id(f.component), []).append(f)
    for f in system.model.fields:
        moving = own.get(id(f.component), [])
        if f.multiplier and not f.fixed.all() and moving and all(g.fixed.all() for g in moving):
            raise InputError(
                f"{f.component.label}: all of its {moving[0].name} is held or prescribed, so that nothing tells its "
                f"{f.name}; leave a part of it free, or, where its material is incompressible, take a "
                "Poisson's ratio below 0.5, 0.4999 say"
            )


def refuse_free(system: System) -> None:
    """Refuse a system with bodies that can move rigidly without resistance, for an analysis without inertia.

    The tangent at the present state is applied to the rigid motions of all bodies; combinations that it sends to
    zero, and that no support forbids, are free.

    Raises
    ------
    InputError
        With the free motions of every body.

    Examples
    --------
    >>> import visviva as vv
    >>> block = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=vv.NeoHooke(young=1, poisson=0.3))
    >>> refuse_free(vv.System([block, vv.Fixed(solid=block, nodes="z0")]))
    """
    refuse_insulated(system)
    bodies = [c for c in system.components if isinstance(c, Attachable)]
    if found := free_bodies(system, bodies, load_step(system.time, 0.0)):
        raise InputError(
            f"nothing holds {', nor '.join(found)}: statics has no solution; hold it by vv.Fixed, "
            "vv.SymmetryPlane, a joint or a spring, or run it in time"
        )


@np.errstate(all="ignore")  # what is not finite is refused by name
def refuse_insulated(system: System) -> None:
    """Refuse bodies whose temperature nothing holds, alone or among themselves, for a steady state.

    The heat that bodies take in follows from their balances: sums of these, where entropy is balanced by the
    temperatures. Where it depends neither on their temperatures nor on what is held, they have any.

    Raises
    ------
    InputError
    """
    refuse_any_amount(system)
    warm = [(c, *both) for c in system.components if (both := _balances(system, c))]
    if not warm:
        return
    r, K = system.tangent(load_step(system.time, 0.0))
    free = system.free_unknowns
    multipliers = np.concatenate([np.full(f.size, f.multiplier) for f in system.model.fields])[free]
    weights, changes = np.zeros((2, len(warm), len(system.x)))
    own = np.zeros(len(warm))
    for k, (_, balance, temperature) in enumerate(warm):
        balances_entropy = balance is not temperature
        size = system.x[temperature] if balances_entropy else np.ones(len(balance))
        weights[k, balance] = changes[k, temperature] = size
        own[k] = size @ r[balance] if balances_entropy else 0.0
    weights, changes = weights[:, free], changes[:, free]
    taken, sizes = (W @ L for W, L in ((weights, K), (np.abs(weights), abs(K))))
    found = np.hstack([taken @ changes.T + np.diag(own), taken[:, multipliers]])
    scale = np.hstack([sizes @ np.abs(changes).T, sizes[:, multipliers]])
    of_each = np.array([temperature[0] for *_, temperature in warm])
    refuse_infinite(system, of_each, scale.sum(axis=1) + own)
    largest = scale.max(axis=1, keepdims=True)
    loose = null_space((found / np.where(largest > TINY, largest, 1.0)).T)
    names = [
        c.label for (c, *_), share in zip(warm, loose, strict=True) if np.abs(share).max(initial=0.0) > CLEAR
    ]
    if names:
        raise InputError(
            f"nothing holds the temperature of {' and '.join(names)}: a steady state has any; hold it by "
            "vv.PrescribedTemperature, let it exchange heat by vv.Convection or vv.HeatExchange, or run it in time"
        )


def refuse_any_amount(system: System) -> None:
    """Refuse contents but heat, such as concentrations, of which nothing holds how much there is, for a steady state.

    Without rates nothing keeps the amount that there was: where the sum of its balances depends on no unknown, there
    may be any.

    Raises
    ------
    InputError
    """
    contents = [f for f in system.model.fields if f.role is Role.CONTENT and not f.component.carries_heat]
    kept_by_rates = [f.component for f in system.model.fields if f.multiplier and not f.instantaneous]
    for f in contents:
        if f.component in kept_by_rates:
            raise InputError(
                f"{f.component.label}: its {f.name} is conserved by its rates, and load steps take no time: nothing "
                "keeps how much there is; run it in time by vv.simulate, until it rests"
            )
    contents = [f for f in contents if not f.fixed.any()]
    if not contents:
        return
    _, K = system.tangent(load_step(system.time, 0.0))
    for f in contents:
        rows = K[np.isin(system.free_unknowns, f.unknowns)]
        if np.abs(rows.sum(axis=0)).max() <= CLEAR * abs(rows).max():
            raise InputError(
                f"{f.component.label}: nothing holds how much {f.name} there is, and a steady state has any; hold it "
                "somewhere, as by vv.PrescribedConcentration, or run it in time by vv.simulate, in which the amount is "
                "kept: what has no density is in balance with it there at all times"
            )


def _balances(system: System, component: Component) -> tuple[Ints, Ints] | None:
    """Unknowns whose equations balance a component's heat, and those of its temperature; others if it is entropy."""
    own = [f for f in system.model.fields if f.component is component]
    contents, temperatures = (
        [u for f in own if f.role is role for u in f.unknowns] for role in (Role.CONTENT, Role.TEMPERATURE)
    )
    if not contents or not (temperatures or component.carries_heat):
        return None
    balance = np.array(contents)
    return balance, np.array(temperatures) if temperatures else balance


def refuse_massless(system: System) -> None:
    """Refuse solids without mass that can move rigidly without resistance, for an analysis in time.

    Raises
    ------
    InputError
        With the free motions of every such solid.

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    >>> refuse_massless(vv.System([vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1, poisson=0.3), density=1.0)]))
    """
    bodies = [body for body, _ in massless(system)]
    if found := free_bodies(system, bodies, EnergyMomentum().step(system.time, 1.0)):
        raise InputError(
            f"{', and '.join(found)} has no mass, and nothing holds it: forces, such as those of a contact, would move "
            "it at any speed; give it a density, or hold it by vv.Fixed, vv.Tie, a joint or a spring"
        )


def massless(system: System) -> Iterator[tuple[MeshBody, Ints]]:
    """Bodies on meshes without mass and the unknowns (n,) of their vectors."""
    for body in system.components:
        if (
            isinstance(body, MeshBody)
            and body.density == 0
            and (vectors := body.vectors(system.model)) is not None
        ):
            yield body, (vectors[0][:, None] + np.arange(vectors[2])).ravel()


def refuse_swinging(system: System, scheme: Scheme) -> None:
    """Refuse bodies without mass out of balance at the start, about which they would swing for ever.

    So they do under schemes that ask for balance in the middle of steps: from there on as far on the other side.

    Raises
    ------
    InputError
        With the body and what to take instead.

    Examples
    --------
    >>> import visviva as vv
    >>> cube = vv.Solid(
    ...     mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=vv.NeoHooke(young=1, poisson=0.3), name="cube"
    ... )
    >>> pull = vv.Traction(solid=cube, faces="x1", traction=(1, 0, 0))
    >>> system = vv.System([cube, vv.Fixed(solid=cube, nodes="x0"), pull])
    >>> refuse_swinging(system, vv.BackwardEuler())
    >>> try:
    ...     refuse_swinging(system, vv.Midpoint())
    ... except vv.InputError as error:
    ...     print(str(error)[:44])
    Solid 'cube' has no density, and is not in b
    """
    light = list(massless(system))
    if not light or not scheme.has_inertia or scheme.theta != 0.5:
        return
    unknown = system.free_unknowns
    force, stiffness = system.tangent(instant(system.time, theta=1.0))
    scale = system.scale[unknown]
    work, stored = np.abs(force[unknown]) * scale, np.abs(stiffness.diagonal()) * scale**2
    for body, own in light:
        mine = np.isin(unknown, own)
        least = BALANCED * stored.max(
            where=mine, initial=0.0
        )  # what nothing stiffens is judged beside the stiffest
        if (work[mine] > BALANCED * np.maximum(stored[mine], least)).any():
            raise InputError(
                f"{body.label} has no density, and is not in balance at the start: {scheme}, which asks for balance in "
                "the middle of steps, would let it swing about it at every step; give it a density, let loads grow "
                "from zero, or take BackwardEuler() or vv.quasi_static"
            )


def free_bodies(system: System, bodies: Sequence[Attachable], step: Any) -> list[str]:
    """Bodies that can move rigidly in a step and meet nothing while all others stay; their motions.

    Nor do those that meet but the turning of forces that are out of balance, as of a composition that strains a body
    at the start: once in balance, nothing is left of it.
    """
    motions = [m for body in bodies if (m := rigid_motions(system, body))]
    if not motions:
        return []
    moves = np.hstack([*(m.moves[:, m.possible] for m in motions), _coordinates(system)])
    null = _free_combinations(system, motions, moves, step)
    ends = np.cumsum([m.possible.sum() for m in motions])
    found = []
    for m, first, end in zip(motions, [0, *ends], ends, strict=False):
        free = np.zeros((6, null.shape[1]))
        free[m.possible] = null[first:end]
        if np.abs(free).max(initial=0.0) > CLEAR and not m.body.is_massless:
            found.append(f"{m.body.label} ({m.in_words(free)})")
    return found


def rigid_motions(system: System, body: Attachable) -> Motions | None:
    """Rigid motions of a body in its present configuration; None for what cannot move."""
    vectors = body.vectors(system.model)
    if vectors is None:
        return None
    starts, is_position, width = vectors
    index = starts[:, None] + np.arange(width)
    x = np.pad(system.x[index], ((0, 0), (0, 3 - width)))
    centre = x[is_position].mean(axis=0)
    arms = x - np.where(is_position[:, None], centre, 0.0)
    moves, size = np.zeros((len(system.x), 6)), np.zeros(6)
    for k, axis in enumerate(np.eye(3)):
        moves[index, k] = np.where(is_position[:, None], axis, 0.0)[:, :width]
        moves[index, 3 + k] = np.cross(axis, arms)[:, :width]
    size = np.abs(moves).max(axis=0)
    moves /= np.where(size > 0, size, 1.0)
    return Motions(body, centre, moves, size, index)


def simplest(span: Array) -> Array:
    """A basis (6, k) of a span (6, m) with a one and zeros in each of k rows."""
    from scipy.linalg import qr

    _, r, rows = qr(span.T, pivoting=True)
    rank = int((np.abs(np.diag(r)) > CLEAR).sum())
    chosen = span[rows[:rank]]
    basis: Array = span @ np.linalg.pinv(chosen)
    return basis


def _coordinates(system: System) -> Array:
    """Unit changes (n, k) of coordinates of joints, which go with the bodies."""
    of_joints = [f for f in system.model.fields if f.order > 0 and not isinstance(f.component, Attachable)]
    unknowns = [u for f in of_joints for u in f.unknowns]
    moves = np.zeros((len(system.x), len(unknowns)))
    moves[unknowns, range(len(unknowns))] = 1.0
    return moves


def _free_combinations(system: System, motions: Sequence[Motions], moves: Array, step: Any) -> Array:
    """Combinations (k, p) of `moves` (n, k), those of the motions first, that meet nothing.

    What they meet are forces and violations of constraints, relative to the terms that cancel in them.
    """
    forces, largest, residual = _met(system, moves, step)
    scale = np.where(largest > TINY, largest, 1.0)
    fixed = np.concatenate([f.fixed for f in system.model.fields])
    bare = _unmet(forces, moves, scale, fixed)
    done = 0
    for m in motions:
        turned = m.turned(step.theta * residual)
        for k in np.flatnonzero(m.possible):
            forces[:, done] -= turned[:, k]
            done += 1
    return np.hstack([bare, _unmet(forces, moves, scale, fixed)])


@np.errstate(all="ignore")  # what is not finite is refused by name
def _met(system: System, moves: Array, step: Any) -> tuple[Array, Array, Array]:
    """Forces (n, k) on `moves`, the largest (n,) of their terms, and the residual, with a tangent that nobody keeps."""
    system.core.find_neighbours()  # bodies may rest on what they touch
    row, col, unknown = (np.asarray(a) for a in system.core.csr)
    values, residual = np.zeros(len(col)), np.zeros(len(system.x))
    system.core.assemble(step, system.signals(step), residual, values)
    K = square(values, col, row)
    forces, met = np.zeros_like(moves), np.zeros_like(moves)
    for k, move in enumerate(moves.T):
        forces[unknown, k] = K @ move[unknown]
    np.abs(K.data, out=K.data)  # where a copy would be the most that a run ever holds
    for k, move in enumerate(moves.T):
        met[unknown, k] = K @ np.abs(move[unknown])
    refuse_infinite(system, np.asarray(unknown), met[unknown].sum(axis=1) + residual[unknown])
    for part in (forces, met, residual):  # of rows that processes share
        world().sum(part)
    return forces, met.max(axis=1), residual


def _unmet(forces: Array, moves: Array, scale: Array, fixed: Any) -> Array:
    """Combinations of moves that meet nothing: no forces, and no fixed unknowns; by triangles (k, k) of some rows."""
    r = np.zeros((0, moves.shape[1]))
    for start in range(0, len(fixed), PIECE):
        some = slice(start, start + PIECE)
        rows = np.where(fixed[some, None], moves[some], forces[some] / scale[some, None])
        r = np.asarray(np.linalg.qr(np.vstack([r, rows]), mode="r"))
    return null_space(r)


def null_space(A: Array) -> Array:
    """Orthonormal combinations (k, p) of the columns of `A` (m, k) that vanish."""
    _, s, vt = np.linalg.svd(np.linalg.qr(A, mode="r"))
    rank = int((s > ROUNDING * np.sqrt(A.shape[1])).sum())
    null: Array = vt[rank:].T
    return null


def _direction(vector: Array) -> str:
    rounded = np.round(vector / np.linalg.norm(vector), 9)
    return _listed(rounded * np.sign(rounded[np.argmax(np.abs(rounded))]))


def _listed(vector: Array) -> str:
    return "(" + ", ".join(f"{c:.4g}" for c in np.round(vector, 9) + 0.0) + ")"
