"""Facts on a system for the choice of its linear solver, and the solvers handed to its core."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.base.world import world
from visviva.linear.choice import (
    TINY,
    Automatic,
    Direct,
    Problem,
    Temperatures,
    n_rigid_motions,
    put_rigid_motions,
)
from visviva.linear.petsc import Petsc
from visviva.linear.staggered import Halves, Staggered
from visviva.model.field import Role
from visviva.system.build import blocks
from visviva.system.shared import n_equations, refuse_unshared_solver

if TYPE_CHECKING:
    from visviva.model.field import Field
    from visviva.model.model import Model
    from visviva.system.system import System

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

WHOLE = 100.0
"""By so much redundant constraints are regularised more in factors of the whole matrix, which do not look for them:
with 1e-13 alone a solution for any right-hand side is lost in rounding, and the matrix taken for singular."""
LARGEST_BLOCK = 20
"""Unknowns of a block up to which rigid bodies are eliminated block by block."""
CARRIED = (Role.VELOCITY, Role.FLUID_PRESSURE)
"""Roles of fields carried along by a flow, which make the tangent unsymmetric."""
HEAT = (Role.CONTENT, Role.TEMPERATURE)
UNSYMMETRIC = (*CARRIED, Role.POTENTIAL, Role.TEMPERATURE)
"""So do potentials and temperatures: what flows by them and their dependence on what is stored are no transposes."""


def uses_null_space(system: System) -> bool:
    """Whether rigid bodies are reduced to six unknowns and eliminated block by block."""
    model = system.model
    if world().size > 1:
        return False
    if system.newton.null_space is not None:
        return system.newton.null_space
    free = np.concatenate([~f.fixed for f in model.fields])
    sizes = np.bincount(blocks(model)[0], weights=free)
    small = bool(np.all((sizes > 0) & (sizes <= LARGEST_BLOCK)))
    small = small and not any(f.is_local for f in model.fields)
    others = model.driving.has_servo or any(c.touches for c in system.components)
    others = others or any(f.role in CARRIED for f in model.fields)
    return small and not model.terms and not others and not model.reductions.slaves


def problem_of(system: System) -> Problem:
    """Tangents of most fields are taken to be symmetric and definite until the solver finds that they are not."""
    core, model = system.core, system.model
    condensed = core.n_exchanged or len(model.reductions.pressures)  # before anything is near
    multipliers = system.n_constraints - core.n_eliminated - core.n_lengths
    if world().size > 1:  # which condense no pressures; entries of nodes that they share count twice
        entries = np.array([float(core.n_entries)])
        world().sum(entries)
        return part_of(system, model.fields, (n_equations(system), int(entries[0])), multipliers, 0)
    return part_of(system, model.fields, (core.n_equations, core.n_entries), multipliers, condensed)


def part_of(
    system: System, those: Sequence[Field], size: tuple[int, int], multipliers: int, condensed: int
) -> Problem:
    """What is to be known of the equations of some fields, from the numbers of these and of their entries."""
    core = system.core
    fields = [f for f in those if not f.is_local]
    potential = all(g.held for g in system.model.growing)  # the damages that history fields drive have none
    symmetric = potential and not any(f.role in UNSYMMETRIC for f in fields)
    conduction = temperatures(those) is Temperatures.ALONE
    fluids = {id(f.component) for f in fields if f.role is Role.VELOCITY}
    flow = sum(int(np.sum(~f.fixed)) for f in fields if id(f.component) in fluids)
    # what tied nodes leave may be a flow alone, when solids that it carries have left
    has_flow = bool(fluids) and (not core.n_eliminated or flow == core.n_equations)
    has_flow = has_flow and not any(f.role is Role.CONTENT for f in fields)  # velocities and pressures alone
    return Problem(
        n=size[0],
        n_entries=size[1],
        symmetric=symmetric,
        nearly=symmetric and system.has_discrete_gradient and not condensed and not conduction,
        definite=conduction or all(f.role.has_least_energy or f.multiplier for f in fields),
        n_multipliers=multipliers,
        has_modes=any(f.node > 1 for f in fields)
        and not system.model.reductions.directors
        and all(f.order > 0 or f.multiplier for f in fields),
        n_pressures=sum(f.size for f in fields if f.role is Role.CONTACT_PRESSURE) - condensed,
        n_condensed=condensed,
        has_inertia=system.has_inertia,
        regularization=system.newton.regularization * WHOLE,
        has_diagonal=bool(condensed or not symmetric) and has_diagonal(fields, core.n_eliminated, condensed),
        temperatures=temperatures(those),
        separates=any(f.role is Role.POTENTIAL for f in fields),
        has_flow=has_flow,
        is_flow=has_flow and all(f.order < 2 for f in fields),
    )


def halves_of(system: System, whole: Problem) -> Halves:
    """Mechanics, and heat: entropies and temperatures, with the multipliers that act on no position."""
    model, slaves = system.model, {m for _, m in system.model.reductions.slaves}
    row, col, unknown = (np.asarray(a) for a in system.core.csr)
    first = np.repeat(unknown, np.diff(row))
    acts = np.bincount(first, system.order[unknown[col]] == 2, model.n_unknowns) > 0
    heat = [
        f
        for f in model.fields
        if f.role in HEAT or (f.multiplier and not acts[f.start : f.start + f.size].any())
    ]
    is_heat = np.zeros(model.n_unknowns, dtype=np.int32)
    for f in heat:
        is_heat[f.start : f.start + f.size] = 1
    free = [int(u) for f in heat if f.multiplier for u in np.asarray(f.unknowns)[~f.fixed]]
    held = len([u for u in free if u not in slaves])
    of, other = is_heat[first], is_heat[unknown[col]]
    sizes = [(int(np.sum(is_heat[unknown] == k)), int(np.sum((of == k) & (other == k)))) for k in (0, 1)]
    others = [f for f in model.fields if f not in heat]
    return Halves(
        part_of(system, others, sizes[0], whole.n_multipliers - held, whole.n_condensed),
        part_of(system, heat, sizes[1], held, 0),
        is_heat,
    )


def temperatures(fields: Sequence[Field]) -> Temperatures:
    """Temperatures among the unknowns: alone, by constant properties, or those of solids that deform."""
    if fields and all(
        f.role is Role.CONTENT and getattr(f.component, "conducts_evenly", False) for f in fields
    ):
        return Temperatures.ALONE
    roles = {f.role for f in fields}
    coupled = Role.TEMPERATURE in roles and not roles.intersection(CARRIED)
    return Temperatures.COUPLED if coupled else Temperatures.NONE


def has_diagonal(fields: Sequence[Field], eliminated: int, condensed: int) -> bool:
    """Whether no entry of the diagonal vanishes: all constraints have left the equations."""
    free = sum(int(np.sum(~f.fixed)) for f in fields if f.multiplier)
    pressures = sum(f.size for f in fields if f.role is Role.CONTACT_PRESSURE)
    others = any(f.role in (Role.STATE, Role.SOLID_PRESSURE, Role.TEMPERATURE) for f in fields)
    return not others and (free, pressures) == (eliminated, condensed)


def rigid_modes(model: Model) -> tuple[Callable[[Ints, Array], None], int]:
    """What puts rigid motions of the nodes of meshes, of some unknowns, where zeros are, and how many there are."""
    fields = [f for f in model.fields if f.node > 1 and f.order == 2]
    places = [(f.start, f.values.reshape(-1, f.node)) for f in fields]

    def put(unknowns: Ints, modes: Array) -> None:
        for start, points in places:
            own = np.flatnonzero((unknowns >= start) & (unknowns < start + points.size))
            put_rigid_motions(points, unknowns[own] - start, modes, own)

    return put, max((n_rigid_motions(f.node) for f in fields), default=0)


def hand_solvers(system: System) -> str:
    """Hand the linear solvers to the core of a system; returns what was chosen, and why."""
    core, newton = system.core, system.newton
    options = refuse_unshared_solver(newton.linear, newton.null_space)
    if options is not None and newton.null_space:
        raise InputError("Newton(linear=...) and null_space=True exclude each other: choose one")
    problem, by_blocks = problem_of(system), uses_null_space(system)
    if options is None and system.has_inertia and (by_blocks or is_plain(problem)):
        core.use_solver(by_blocks, newton.regularization)
        project_in_core(system, by_blocks)
        return f"{core.n_equations} equations: {core.solver}"
    core.set_modes(*rigid_modes(system.model))
    if isinstance(options, Staggered) and problem.temperatures is Temperatures.COUPLED:
        choice = options.choose_in_turn(problem, halves_of(system, problem))
    else:
        choice = (options or Automatic()).choose(problem)
    core.use_linear(list(choice.in_order))
    project_in_core(system, False)
    return choice.explanation if world().size == 1 else f"{world().size} processes, {choice.explanation}"


def is_plain(problem: Problem) -> bool:
    """In time steps there is nothing to choose: the sparse LU that is always there is as fast as anything."""
    return problem.is_small and (problem.n_entries <= TINY or not problem.is_solid)


def project_in_core(system: System, by_blocks: bool) -> None:
    """Let the core project the rates of motion, the equations of which are symmetric: mass and constraints."""
    if not system.has_lasting_constraints or np.any(system.order == 1) or system.model.driving.has_servo:
        return
    constraint = system.is_lasting_constraint.astype(np.int32)
    regularization = system.newton.regularization
    row, col, _ = system.core.csr
    rates = Problem(
        n=len(row) - 1,
        n_entries=len(col),
        symmetric=True,
        n_multipliers=int(constraint.sum()),
        regularization=regularization * WHOLE,
    )
    if world().size > 1:
        system.core.use_rate_linear(list(Petsc().choose(rates).in_order), constraint)
    elif by_blocks or rates.is_small:
        system.core.use_rate_solver(by_blocks, regularization, constraint)
    else:
        system.core.use_rate_linear(list(Direct().choose(rates).in_order), constraint)
