"""The core of a system, built from what its components have declared and contributed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.base.timefunction import TimeFunction
from visviva.base.world import world
from visviva.component.announcements import SharedOut
from visviva.component.component import Component
from visviva.component.within import within
from visviva.model.field import Role, supply_of
from visviva.model.stencil import inertia_terms, strain_terms
from visviva.system.agreement import agree_on_starts

if TYPE_CHECKING:
    from visviva.model.driving import Driving
    from visviva.model.model import Model
    from visviva.system.system import System

Ints = NDArray[np.int32]


def build_core(system: System) -> _core.System:
    """The core with its terms and the numbers of the unknowns, ready for a linear solver."""
    model = system.model
    agree_on_starts(model.fields)
    order = np.concatenate([np.full(f.size, f.order, dtype=np.int32) for f in model.fields])
    fixed = np.concatenate([f.fixed for f in model.fields]).astype(np.int32)
    flows = np.concatenate([np.full(f.size, f.role is Role.VELOCITY, dtype=np.int32) for f in model.fields])
    core = _core.System(order, fixed, system.scale, flows)
    terms = [*inertia_terms(model), *strain_terms(model), *model.batches]
    terms += [term.build(model, component) for term, component in model.terms]
    held = supplied(model)
    stored = {model.index(f.component) for f in model.fields if f.role is Role.CONTENT}
    by_contents = np.array(  # after the terms have opened theirs
        [
            a.category == "heat" or (a.category == "dissipation" and a.component in stored)
            for a in model.accounts
        ],
        dtype=np.int32,
    )
    core.set_accounts(len(by_contents), len(system.components), by_contents)
    if world().size > 1:
        core.set_processes(world().of_core())
    shared = {id(s.term) for c in system.components for s in model.announced(c, SharedOut)}
    for term in terms:
        core.add(term if world().rank == 0 or id(term) in shared else _core.Mirror(term))
    core.set_blocks(*blocks(model))
    core.set_judged(judged(model))
    core.set_nodes(nodes(model))
    if any(f.beside for f in model.fields):
        core.set_places(places(model))
    if any(c.collides for c in system.components):
        core.set_islands(*islands(model))
    model.entropies.hand_over(core)
    model.driving.given.update(kinks_given(system))
    hand_driving(core, model.driving)
    core.set_prescribed(*held)
    hand_reductions(core, system)
    core.finalize()
    if model.growing:
        core.set_cracking(all(getattr(g.field.component, "density", 0.0) > 0 for g in model.growing))
    resting = [g.field for g in model.growing if g.held]
    if resting:
        core.set_monotone([u for f in resting for u in np.asarray(f.unknowns)[~f.fixed].tolist()])
    return core


def kinks_given(system: System) -> Iterator[float]:
    """Times at which functions of time have kinks that its components were given, whatever for."""
    for c in system.components:
        for f in fields(c):
            given = within(getattr(c, f.name), TimeFunction, (Component,))
            yield from (t for function in given for t in function.kinks)


def hand_driving(core: _core.System, driving: Driving) -> None:
    """Parts driven by functions of time."""
    core.set_signal_count(max(len(driving.signals), 1))
    if driving.drives:
        core.set_drives(*columns(driving.drives))


def hand_reductions(core: _core.System, system: System) -> None:
    """Reductions of the equations before they are solved."""
    reductions = system.model.reductions
    if (system.local >= 0).any():
        core.condense_elements(system.local)
    if world().size > 1:  # each of which knows a part of the rows that the others would need
        return
    if reductions.slaves and not system.newton.null_space:  # which takes constraints block by block
        core.eliminate_slaves(*columns(reductions.slaves))
    if reductions.pressures:  # of contact, by the momentum of their nodes
        core.condense_contact(*columns(reductions.pressures))
    if reductions.directors:
        core.eliminate_directors(*columns(reductions.directors))


def supplied(model: Model) -> tuple[Ints, ...]:
    """Held unknowns that take in work or heat: their numbers, accounts, and what they take in."""
    rows = [(int(u), p.account, p.supply) for p in model.driving.prescribed for u in p.unknowns]
    moving = {u for u, _, _ in rows}
    for f in model.fields:
        still = [u for u in f.unknowns if f.order == 1 and f.fixed[u - f.start] and u not in moving]
        rows += [(u, model.account(f.component, "supply", supply_of(f)), f.role.supply) for u in still]
    return tuple(np.ascontiguousarray(column) for column in np.array(rows, dtype=np.int32).reshape(-1, 3).T)


def columns(rows: Any) -> Ints:
    """Columns of a list of tuples, each in one piece."""
    return np.array(rows, dtype=np.int32).T.copy()


def blocks(model: Model) -> tuple[Ints, ...]:
    """Block of each unknown, stage of each block, which unknowns are multipliers; unknowns (n, 18) of rigid bodies."""
    numbers: dict[Any, int] = {}
    stages: list[int] = []
    block = np.zeros(model.n_unknowns, dtype=np.int32)
    multiplier = np.zeros_like(block)
    for f in model.fields:
        part = f.part or max(f.size, 1)
        for k in range(0, f.size, part):
            if f.part and np.all(f.fixed[k : k + part]):
                continue  # without equations the number does not matter
            key = (f.block, k // part) if f.part else f.block
            if key not in numbers:
                numbers[key] = len(numbers)
                stages.append(f.stage)
            block[f.start + k : f.start + k + part] = numbers[key]
        multiplier[f.start : f.start + f.size] = f.multiplier and f.stage > 0
    rigid = np.array(model.reductions.rigid, dtype=np.int32).reshape(-1, 18)
    return block, np.array(stages, dtype=np.int32), multiplier, rigid


def judged(model: Model) -> Ints:
    """Multipliers that stand for forces in space, which Newton's method judges beside coordinates."""
    bearing = (f for f in model.fields if f.multiplier or f.role is Role.CONTACT_PRESSURE)
    return np.array([u for f in bearing for u in f.unknowns], dtype=np.int32)


def islands(model: Model) -> tuple[Ints, ...]:
    """Number of the connected part (by constraints) that each unknown is in; accounts of constraints with theirs."""
    import scipy.sparse as sp
    from scipy.sparse.csgraph import connected_components

    owner = np.concatenate([np.full(f.size, model.index(f.component)) for f in model.fields])
    pairs = {
        (int(owner[u + e.shift]), e.component)
        for e in model.elements
        if len(e.multipliers)
        for strain in e.strains
        for u in strain.unknowns
    }
    a, b = columns([*pairs, (0, 0)])
    graph = sp.coo_array((np.ones(len(a)), (a, b)), shape=(len(model.components),) * 2)
    island = connected_components(graph, directed=False)[1].astype(np.int32)
    accounts = [k for k, a in enumerate(model.accounts) if a.category == "constraint"]
    of_accounts = island[[model.accounts[k].component for k in accounts]]
    return island[owner], np.array(accounts, dtype=np.int32), of_accounts


def places(model: Model) -> Ints:
    """A number of the place of each unknown: the first unknown of the node there of the field it is beside."""
    at = nodes(model)
    for f in model.fields:
        if f.beside:
            there = f.beside.start + np.arange(f.size // f.node) * f.beside.node
            at[f.start : f.start + f.size] = np.repeat(there, f.node)
    return at


def nodes(model: Model) -> Ints:
    """First unknown of the node of each unknown."""
    starts = [f.start + np.arange(f.size) // f.node * f.node for f in model.fields]
    return np.concatenate(starts).astype(np.int32)


def check_finite(system: System) -> None:
    """Refuse initial values that are no numbers."""
    if np.isfinite(system.x).all() and np.isfinite(system.v).all():
        return
    for f in system.model.fields:
        if not (np.isfinite(f.values).all() and np.isfinite(f.rates).all()):
            raise InputError(f"{f.component.label}: its initial {f.name} is not finite: {f.values.tolist()}")
