"""Components of the user in Python: a force, an energy, a constraint, or a whole term.

Each looks at measures: points (three coordinates each), joints (their coordinate), `SquaredDistance`,
`DirectorProduct`, `Offset`, `Position`, or a function without arguments that returns forms and strains.
Measures are at most quadratic in the unknowns, so the energy-momentum scheme conserves energy exactly for any
function of them, and momentum and angular momentum where the measures do not change under rigid motions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.component import Component, settings
from visviva.component.values import Function
from visviva.load.force import add_user_force, guarded
from visviva.measure.measures import measures_of, strains_of
from visviva.model.callback import constraint_callback, energy_callback
from visviva.model.law import Law, LawKind
from visviva.model.term import Term

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class _OnMeasures(Component):
    """Base of what acts on measures.

    Parameters
    ----------
    of : list
        What it looks at, numbered through: components and points (three coordinates each), joints (their coordinate),
        measures such as `SquaredDistance`, functions without arguments that return forms or strains.
    """

    of: Any

    def __post_init__(self) -> None:
        self._measures = measures_of(self.label, self.of)

    def announce(self, model: Model) -> None:
        for measure in self._measures:
            measure.announce(model)


@dataclass(config=settings, eq=False, kw_only=True)
class GeneralizedForce(_OnMeasures):
    """Force given as a function of time and state: ``force(t, e, rate)``, all but t of shape (n_e,).

    `e` and `rate` are the measures and their rates at the evaluation point of the scheme; the result does
    work on them: for points it is the force, for an angle the torque. Its work is booked as "user force".

    Parameters
    ----------
    of : list
        What it looks at, numbered through: components and points (three coordinates each), joints (their coordinate),
        measures such as `SquaredDistance`, functions without arguments that return forms or strains.
    force : callable
        ``force(t, e, rate)`` with values (n_e,).

    Examples
    --------
    >>> import numpy as np, visviva as vv
    >>> a, b = vv.PointMass(mass=1.0), vv.PointMass(mass=1.0, position=(1, 0, 0))
    >>> def wind(t, x, v):
    ...     return -0.1 * np.abs(v) * v
    >>> system = vv.System([a, b, vv.GeneralizedForce(of=[a, b], force=wind)])
    """

    force: Function

    def contribute(self, model: Model) -> None:
        add_user_force(model, self, "user force", strains_of(self, self._measures), self.force)


@dataclass(config=settings, eq=False, kw_only=True)
class Potential(_OnMeasures):
    """Potential given by its energy only: ``energy(e)`` maps measures (n_e, n) to energies (n,).

    The function works elementwise on n states at once (``e[0]`` is the first measure in all of them).
    Stress, tangent and discrete gradient follow by the complex step (differences where the function refuses
    complex numbers).

    Parameters
    ----------
    of : list
        What it looks at, numbered through: components and points (three coordinates each), joints (their coordinate),
        measures such as `SquaredDistance`, functions without arguments that return forms or strains.
    energy : callable
        ``energy(e)`` of measures (n_e, n) with values (n,).
    kind : str
        Its account in the ledger.

    Examples
    --------
    >>> import visviva as vv
    >>> a, b = vv.PointMass(mass=1.0), vv.PointMass(mass=2.0, position=(1, 0, 0), velocity=(0, 1, 0))
    >>> gravitation = vv.Potential(of=[vv.SquaredDistance(a=a, b=b)], energy=lambda e: -2.0 / e[0] ** 0.5)
    >>> result = vv.simulate(vv.System([a, b, gravitation]), until=1.0, step=0.01)
    >>> result.assert_conserved("energy", "angular_z", "momentum_x", tolerance=1e-9)
    """

    energy: Function
    kind: str = "user"

    def contribute(self, model: Model) -> None:
        strains = strains_of(self, self._measures)
        W = guarded(self.label, "energy", self.energy)
        call = energy_callback(W, len(strains), f"{self.label}, its energy", model.sizes_of(strains))
        model.potential(self, self.kind, strains, Law(LawKind.ENERGY_CALLBACK, callback=call))


@dataclass(config=settings, eq=False, kw_only=True)
class Constraint(_OnMeasures):
    """Constraints given by their function only: ``function(e) = 0``.

    The function maps measures (n_e, k) of k states at once to `n` values (n, k). The initial state must
    satisfy it; gradients follow as for `Potential`.

    Parameters
    ----------
    of : list
        What it looks at, numbered through: components and points (three coordinates each), joints (their coordinate),
        measures such as `SquaredDistance`, functions without arguments that return forms or strains.
    function : callable
        ``function(e)`` of measures (n_e, k) with values (n, k), zero where they are fulfilled.
    n : int
        How many constraints these are, at least one.

    Examples
    --------
    A bead on a parabola:

    >>> import visviva as vv
    >>> bead = vv.PointMass(mass=1.0, position=(1, 0, 1))
    >>> wire = vv.Constraint(of=[bead], function=lambda x: [x[2] - x[0] ** 2, x[1]], n=2)
    >>> result = vv.simulate(vv.System([bead, wire, vv.Gravity()]), until=1.0, step=0.01)
    >>> result.assert_conserved("energy", "constraints", tolerance=1e-9)
    """

    function: Function
    n: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.n < 1:
            raise InputError(f"{self.label}: n = {self.n} constraints; at least one is needed")

    def contribute(self, model: Model) -> None:
        strains = strains_of(self, self._measures)
        Phi = guarded(self.label, "function", self.function)
        label, sizes = f"{self.label}, its function", model.sizes_of(strains)
        call = constraint_callback(Phi, len(strains), self.n, label, sizes)
        law = Law(LawKind.FUNCTION_CALLBACK, callback=call)
        self._multipliers = model.multipliers(self, "reaction", self.n, block=self)
        model.constrain(self, self._multipliers, strains, law=law, n=self.n)


@dataclass(config=settings, eq=False, kw_only=True)
class UserTerm(Component):
    """A whole `Term`: its residual over a step, with or without tangent, on all coordinates of components.

    Parameters
    ----------
    term : Term
        Its `unknowns` (1, n_local) and `order` (n_local,) are set to the coordinates of `on`, in that order;
        for other stencils or own fields write a `Component` with `declare` and `contribute`.
    on : list of components
        Whose coordinates the term sees.

    Notes
    -----
    A whole term sees rates and second rates at the evaluation point and both ends of the step, so it can hold
    any discrete derivative. The system is solved by its sparse solver then.

    Examples
    --------
    >>> import visviva as vv
    >>> class Drag(vv.Term):
    ...     kind = "drag"
    ...     def residual(self, s):
    ...         return 0.5 * s.rate
    >>> ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0))
    >>> result = vv.simulate(vv.System([ball, vv.UserTerm(term=Drag(), on=[ball])]), until=1.0, step=0.1)
    >>> result.assert_conserved("energy", tolerance=1e-12)
    """

    term: Term
    on: list[Component]

    def contribute(self, model: Model) -> None:
        fields = [f for c in self.on for f in model.fields if f.component is c and f.order > 0]
        if not fields:
            raise InputError(f"{self.label}: what it acts on has no coordinates")
        unknowns = np.concatenate([np.array(f.unknowns, dtype=np.int32) for f in fields])
        self.term.unknowns = unknowns[None, :]
        self.term.order = np.concatenate([np.full(f.size, f.order, dtype=np.int32) for f in fields])
        for what in ("residual", "tangent", "energy", "work", "momentum", "accept"):
            method = type(self.term).__dict__.get(what)
            if method is not None:
                setattr(self.term, what, guarded(self.label, what, method.__get__(self.term)))
        model.term(self, self.term)
