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
        Strains of the reference, which the energy does not see.
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
        callback = evolving_callback(energy) if isinstance(energy, Evolving) else callback_of(energy)
        model.keep(callback)
        term.set_callback(callback, list(start))
    has_mass = any(g.mass is not None for g in groups)
    kinetic = model.account(component, "kinetic", "kinetic") if has_mass else -1
    stored = model.account(component, "stored", "potential")
    lost = model.account(component, "dissipated", "dissipation")
    term.book_point(stored, kinetic, lost, model.index(component))
    model.batch(term)
    return term
