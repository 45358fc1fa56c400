"""Physics at quadrature points: what components with several fields hand to the core at once.

A point sees local unknowns, which are weighted sums of the unknowns of an element's nodes: values, gradients, values at
other points. A strain map makes strains of them, an energy stresses of the strains, and a pairing says which equation
receives what; the core compiles which of them go together (`PhysicsKind`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.model.callback import Function, callback_of
from visviva.model.field import Owner
from visviva.model.history import Evolving, evolving_callback
from visviva.model.model import Model

Array = NDArray[np.float64]
PhysicsKind = _core.PhysicsKind


@dataclass(frozen=True)
class Group:
    """Unknowns of m elements that are interpolated alike.

    Attributes
    ----------
    unknowns : int array, (m, k)
        First unknown of each of k nodes.
    weights : array, (m, q, k, c) or (q, k, c)
        For each of q points the c columns of local unknowns, such as shape functions and their gradients.
    mass : array, (m, k (k + 1) / 2), optional
        Between nodes, packed upper triangle by rows.
    is_position : bool
        Whether they move along under a translation, and so make up linear momentum.
    """

    unknowns: NDArray[np.integer]
    weights: Array
    mass: Array | None = None
    is_position: bool = False


def add_points(
    model: Model,
    component: Owner,
    kind: PhysicsKind,
    groups: Sequence[Group],
    volume: Array,
    parameters: ArrayLike,
    reference: ArrayLike | None = None,
    energy: Function | None = None,
    start: Sequence[float] = (),
) -> _core.PointTerm:
    """Add elements of one physics to the model.

    Parameters
    ----------
    kind : PhysicsKind
    groups : sequence of Group
        In the order of the physics.
    volume : array, (m, q)
        Weights of the points.
    parameters : array_like, (p,) or (m, q, p)
        Of the energy and of the pairing.
    reference : array_like, (m, q, n), optional
        All n strains of the map in the reference, which the energy does not see.
    energy : Function or Evolving, optional
        The user's, in place of the physics' own: of the same strains.
    start : sequence of float
        Where the internal variables of an `Evolving` energy begin.

    Returns
    -------
    PointTerm
        Its energy is booked as "stored", what internal variables and pairings lose as "dissipated".

    Raises
    ------
    InputError
        If groups or parameters are not those of the physics.
    """
    volume = np.asarray(volume, dtype=float)
    kind_groups, n_strains = _core.point_shape(kind)
    refuse_misfits(component, groups, volume, parameters, model.n_unknowns, kind_groups)
    refuse_reference(component, reference, (*volume.shape, n_strains))
    m, q = volume.shape
    tables = [
        (
            np.ascontiguousarray(np.broadcast_to(g.weights, (m, q, *g.weights.shape[-2:])), dtype=float),
            None if g.mass is None else np.ascontiguousarray(g.mass, dtype=float),
            g.is_position,
        )
        for g in groups
    ]
    size = np.shape(parameters)[-1]
    try:
        term = _core.PointTerm(
            kind,
            np.ascontiguousarray(np.hstack([g.unknowns for g in groups]), dtype=np.int32),
            tables,
            np.ascontiguousarray(volume, dtype=float),
            np.ascontiguousarray(np.broadcast_to(parameters, (m, q, size)), dtype=float),
            None if reference is None else np.ascontiguousarray(reference, dtype=float),
        )
    except ValueError as error:
        raise InputError(f"{component.label}: {error}") from error
    term.name = component.label
    if energy is not None:
        refuse_energy(component, energy, start, term.n_strains)
        callback = evolving_callback(energy) if isinstance(energy, Evolving) else callback_of(energy)
        model.keep(callback)
        term.set_callback(callback, list(start))
    has_mass = any(g.mass is not None for g in groups)
    kinetic = model.account(component, "kinetic", "kinetic") if has_mass else -1
    stored, lost = open_accounts(model, component)
    term.book_point(stored, kinetic, lost, model.index(component))
    model.batch(term)
    return term


def open_accounts(model: Model, component: Owner) -> tuple[int, int]:
    """Numbers of the accounts of what is stored and of what is dissipated."""
    stored = model.account(component, "stored", "potential")
    return stored, model.account(component, "dissipated", "dissipation")


def refuse_misfits(
    component: Owner,
    groups: Sequence[Group],
    volume: Array,
    parameters: ArrayLike,
    n_unknowns: int,
    components: Sequence[int],
) -> None:
    """Refuse sizes that do not go together, unknowns that are none, numbers that are not finite.

    Raises
    ------
    InputError
    """

    def refuse(what: str) -> InputError:
        return InputError(f"{component.label}: {what}")

    if volume.ndim != 2 or not np.all(np.isfinite(volume)) or not np.all(volume > 0):
        raise refuse(f"volume needs positive numbers (m, q), got shape {volume.shape}")
    m, q = volume.shape
    if np.ndim(parameters) not in (1, 3) or not np.all(np.isfinite(np.asarray(parameters, dtype=float))):
        raise refuse("parameters need finite numbers (p,) or (m, q, p)")
    for k, g in enumerate(groups):
        unknowns, weights = np.asarray(g.unknowns), np.asarray(g.weights)
        if not np.issubdtype(unknowns.dtype, np.integer) or unknowns.ndim != 2 or len(unknowns) != m:
            raise refuse(
                f"group {k} needs whole numbers ({m}, nodes) as unknowns, got shape {unknowns.shape}"
            )
        of_node = components[k] if k < len(components) else 1
        if unknowns.size and (unknowns.min() < 0 or unknowns.max() + of_node > n_unknowns):
            raise refuse(
                f"group {k} names unknowns beyond the {n_unknowns} of the model: {unknowns.max()} is the first of "
                f"{of_node} of a node"
            )
        nodes = unknowns.shape[1]
        if weights.ndim not in (3, 4) or weights.shape[-3:-1] != (q, nodes) or weights.shape[0] not in (m, q):
            raise refuse(f"group {k} needs weights ({m}, {q}, {nodes}, columns), got shape {weights.shape}")
        mass = np.zeros((m, nodes * (nodes + 1) // 2)) if g.mass is None else np.asarray(g.mass)
        if mass.shape != (m, nodes * (nodes + 1) // 2):
            raise refuse(f"group {k} needs mass {(m, nodes * (nodes + 1) // 2)}, got shape {mass.shape}")
        if not np.all(np.isfinite(weights)) or not np.all(np.isfinite(mass)):
            raise refuse(f"group {k} has weights or mass that are not finite")


def refuse_reference(component: Owner, reference: ArrayLike | None, shape: tuple[int, ...]) -> None:
    """Refuse strains of the reference that are not finite, or not as many as points and strains.

    Raises
    ------
    InputError
    """
    if reference is None:
        return
    strains = np.asarray(reference, dtype=float)
    if strains.shape != shape or not np.all(np.isfinite(strains)):
        raise InputError(
            f"{component.label}: reference needs finite strains {shape}, of every point, got shape {strains.shape}; "
            "np.broadcast_to(strains, shape) repeats the same ones"
        )


def refuse_energy(component: Owner, energy: Function, start: Sequence[float], n_strains: int) -> None:
    """Refuse an energy of other strains than those of the physics, or a start of other variables than it has.

    Raises
    ------
    InputError
    """
    if not isinstance(energy, Function):
        raise InputError(f"{component.label}: energy = {energy!r} is no Function or Evolving of strains")
    n_e, n_h = (energy.n_strains, energy.n_h) if isinstance(energy, Evolving) else (energy.n_e, 0)
    if n_e != n_strains:
        raise InputError(f"{component.label}: its energy sees {n_e} strains, this physics has {n_strains}")
    if len(start) != n_h or not np.all(np.isfinite(np.asarray(start, dtype=float))):
        raise InputError(
            f"{component.label}: start = {list(start)} gives no finite value to each of {n_h} internal variables"
        )
