"""Eigenmodes of small vibrations about an equilibrium."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.linearized import (
    Linearized,
    is_symmetric,
    linearized,
    refuse_first_order,
    refuse_lossy,
    refuse_unfit,
)
from visviva.analysis.shapes import Shapes
from visviva.analysis.vibration import found_modes
from visviva.analysis.whirl import complex_modes, gyroscopic
from visviva.base.arguments import positive, whole
from visviva.base.errors import InputError
from visviva.component.component import refuse_changed
from visviva.system.agreement import refuse_different_arguments
from visviva.system.consistency import accelerations
from visviva.system.growing import refuse_growth
from visviva.system.instant import Instant, instant
from visviva.system.memory import undisturbed
from visviva.system.scaling import typical

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass
class Modes(Shapes):
    """Modes in order of the sizes of their frequencies; print it for a table.

    Attributes
    ----------
    system : System
        With the configuration that they are about.
    shapes : array (k, unknowns)
        Directions in the unknowns of the system, of unit modal mass; complex where gyroscopic forces act or forces
        have no potential, and then relative to a frame that spins, if there is one.
    roots : array (k,)
        Motions go like ``exp(root t)``, one root of each pair: with a real part above zero they grow.
    """

    roots: NDArray[np.complex128]

    @property
    def squared(self) -> NDArray[Any]:
        """Squares (k,) of the angular frequencies: negative where the equilibrium is unstable, complex in flutter."""
        squares = -(self.roots**2)
        return squares if np.any(squares.imag) else squares.real

    @property
    def angular(self) -> NDArray[Any]:
        """Angular frequencies (k,) in rad per time; complex if any mode grows."""
        return -1j * self.roots if np.any(self.roots.real) else self.roots.imag

    @property
    def frequencies(self) -> NDArray[Any]:
        """Frequencies (k,) in cycles per time; complex if any mode grows."""
        cycles: NDArray[Any] = self.angular / (2 * np.pi)
        return cycles

    @property
    def stable(self) -> bool:
        """True if none of the modes found grows. Others may: ask for more, those of stiff parts included."""
        return bool(np.all(self.roots.real <= 0))

    @property
    def flutters(self) -> bool:
        """True if one of the modes found is a growing vibration (flutter). Modes not computed may be one as well."""
        return bool(np.any((self.roots.real > 0) & (self.roots.imag > 0)))

    def __str__(self) -> str:
        lines = [" mode   frequency [1/T]   angular [rad/T]   moves most"]
        for k, root in enumerate(self.roots.tolist()):
            text = f"{root.imag / (2 * np.pi):18.9g}{root.imag:18.9g}"
            if root.real > 0:
                how = f"flutters at {root.imag:.6g} rad/T and" if root.imag else "unstable,"
                text = f"      {how} grows like exp({root.real:.6g} t)"
            lines.append(f"{k + 1:5d}{text}   {self.leader(k)}")
        growing = int(np.sum(self.roots.real > 0))
        lines.append(f" {growing or 'none'} of the {len(self.roots)} modes found grow")
        return "\n".join(lines)


def modes(system: System, n: int = 10, *, tolerance: float = 1e-6) -> Modes:
    """Undamped eigenmodes of small vibrations about the present configuration, which must be an equilibrium.

    ``(r^2 M + r C + K) z = 0`` with ``G z = 0``; `K` contains the geometric stiffness of reactions, of prestress and of
    loads, `C` the gyroscopic forces of a `RotatingFrame` or of terms of the user. Without them, and where forces have a
    potential, ``r = i omega``.

    Parameters
    ----------
    n : int
        How many: those of lowest square (in large systems, and where roots are complex: those nearest to zero).
    tolerance : float
        Largest unbalanced force, relative to the largest force. Damage may be 0.01 from its
        balance, or this if it is more.

    Returns
    -------
    Modes
        Roots, frequencies and shapes; it tells growing modes and flutter, of those found alone.

    Raises
    ------
    InputError
        If the configuration is no equilibrium, something in it has no undamped modes, or the frequency of a mode that
        bends a body is lost in rounding (beams of a radius below some 4e-6 of their length); the message names it.

    Notes
    -----
    Supported are bodies, joints, springs, solids of every formulation, incompressible ones among them, ties and dead
    loads. Dampers are left out, velocities are taken as zero, prescribed motions and loads keep their present values.

    Contact counts as it is: gaps closed by multipliers are constraints, those of a penalty springs, open ones nothing.
    Friction that sticks holds along the surface, by constraints or by its tangential stiffness. Fibres that only pull
    have the stiffness of one side where they are just slack, and cracks whose `split` lets them press where they are
    just closed. Damages of a `FracturingSolid` stay as they are: one that is about to grow does so in the first swing,
    and rests in all others.

    Loads that follow may make modes grow: without vibrating (divergence) or while they do (flutter). What spins about
    a fixed axis is seen from a `RotatingFrame`.

    Refused, by name, are fluids, heat and what else is of first order in time, with all that is immersed; servos,
    friction that slips or whose sticking tractions make the stiffness unsymmetric; surfaces that touch without
    pressure; motion without mass.

    Examples
    --------
    >>> from copy import deepcopy
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, -1))
    >>> rod = vv.Distance(a=ground.point(), b=ball.point())
    >>> parts = [ground, ball, rod, vv.Gravity(acceleration=(0, 0, -4))]
    >>> vv.modes(vv.System(deepcopy(parts))).angular.round(9).tolist()
    [2.0, 2.0]

    Seen from a frame that spins about its axis a Foucault pendulum has two frequencies:

    >>> spinning = vv.System([*deepcopy(parts), vv.RotatingFrame(angular_velocity=(0, 0, 0.5))])
    >>> vv.modes(spinning).angular.round(9).tolist()
    [1.5, 2.5]
    """
    from visviva.system.system import refuse_no_system

    refuse_no_system("modes", system)
    refuse_changed(system)
    whole("modes", "n", n)
    positive("modes", "tolerance", tolerance)
    refuse_different_arguments("modes", n=n, tolerance=tolerance)
    if not len(system.free_unknowns):
        raise InputError(
            "all that moves is held or prescribed: there are no modes; leave something free to move"
        )
    refuse_first_order("modes", system)
    with undisturbed(system):
        at = Instant(system)
        at.factor()
        balance(system, at, tolerance)
        linear = linearized(at)
        roots, z = found_roots(linear, n)
    shapes = np.zeros((len(roots), len(system.x)), dtype=z.dtype)
    shapes[:, at.coordinates] = z.T
    return Modes(system, shapes, roots)


def found_roots(linear: Linearized, n: int) -> tuple[NDArray[np.complex128], NDArray[Any]]:
    """Roots and vectors; real ones where forces have a potential and none is gyroscopic."""
    system, C = linear.at.system, gyroscopic(linear.at)
    refuse_unfit("modes", system)
    rubs = system.model.driving.has_servo or any(c.rubs for c in system.components)
    if rubs or (C is None and is_symmetric(linear)):
        refuse_lossy("modes", linear)
        if C is None:
            squared, z = found_modes(linear, n)
            return np.sqrt(0j - squared), z
    return complex_modes(linear, 0 * linear.at.M if C is None else C, n)


def balance(system: System, at: Instant, tolerance: float) -> None:
    """Give the multipliers their static values, or refuse a configuration that is no equilibrium."""
    refuse_growth("modes", system, tolerance)
    a, multipliers = accelerations(system, at, still=True)
    pull, carried = at.M @ a, at.G.T @ multipliers
    largest = float(np.abs(carried).max(initial=0.0) + np.abs(pull).max(initial=0.0))
    K = system.tangent(instant(system.time, theta=1.0))[1]
    moved = (system.x - system.model.initial[0])[system.free_unknowns]
    moved[system.order[system.free_unknowns] == 0] = 0.0
    largest += float(np.abs(K @ moved).max(initial=0.0))  # about what the strained exert
    stiff = (
        float(abs(K).max() * at.scale.max(initial=0.0)) if K.nnz else 0.0
    )  # a mesh at rest has forces of round-off
    noise = 1e-12 * max(typical(at.M.diagonal()), stiff)
    rounded = 16 * np.finfo(float).eps * (abs(K) @ np.abs(system.x[system.free_unknowns]))[at._q]
    loose = np.maximum(np.abs(pull) - rounded, 0.0)
    if len(pull) and loose.max() > tolerance * largest and largest > noise:
        k = int(np.argmax(loose))
        component, unknown = system.describe(int(at.coordinates[k]))
        raise InputError(
            f"the present configuration is no equilibrium: a force of {pull[k]:.3g} acts on {unknown} of "
            f"{component}; call equilibrium(system) first"
        )
    keep_better(system, at, multipliers)


def keep_better(system: System, at: Instant, multipliers: Array) -> None:
    """Give the multipliers these values, unless those of the last step hold what moves as well or better.

    Accelerations tell them to what rounding leaves of the stiffest constraint, which may be more than all the loads
    of small bodies; those of a load step balance its loads.
    """
    before, left = system.x[at.multipliers].copy(), []
    for values in (multipliers, before):
        system.x[at.multipliers] = values
        force = system.residual(instant(system.time, theta=1.0))[at.coordinates]
        left.append(float(np.abs(force * at.scale).max(initial=0.0)))
    if left[0] <= left[1]:
        system.x[at.multipliers] = multipliers
    system.invalidate()
