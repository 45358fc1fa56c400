"""Stability of equilibria: negative eigenvalues of the tangent, less those due to constraints.

The tangent ``[[K, G^T], [G, 0]]`` of n coordinates and m independent constraints has m negative eigenvalues, and one
more for each direction that the constraints leave free in which energy falls (Sylvester's law of inertia). A direct
solver's factors tell their number; where they do not, small systems are factored once more as ``L D L^T``. Damages
that rest are left out; those that grow count as if they could shrink, too: what is stable then is so all the more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.body.formulation import SUITED
from visviva.body.solid import Solid
from visviva.system.growing import resting_unknowns
from visviva.system.local import condensed
from visviva.system.scaling import asymmetry, equilibration
from visviva.system.shared import n_equations

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.system.system import System

Array = NDArray[np.float64]

LARGEST, CONFIRMED, FULL = 6000, 2000, 600
"""Equations up to which a tangent is factored for its signs alone, and as a full matrix where directions seem to fall,
as factors without exchange of rows lose signs of what is soft, and at once."""
UNSYMMETRIC, BY_DIFFERENCES = 1e-11, 1e-7
"""Allowed difference of entries of an equilibrated tangent across the diagonal; the latter where derivatives may be
differences."""
COMPLIANCE = 1e-6
"""Of scaled constraints, so that they have pivots too; it leaves the signs of all but the hardest directions."""
UNBALANCED = 10.0
"""Lengths of the system over which a force out of balance may seem a stiffness."""
NEUTRAL, ROUNDING = 1e-13, 1e-10
"""Scaled pivots nearer to zero are those of motions that nothing resists; the latter with constraints, or where
derivatives may be differences."""


@dataclass
class Stability:
    """Counts of equilibria that a run found: all, unstable ones, and those whose stability is not known.

    `critical` counts the steps across which the number of `falling` directions changed.
    """

    equilibria: int = 0
    unstable: int = 0
    unchecked: int = 0
    first: float = 0.0  # load parameter of the first unstable one
    falling: int = 0  # directions in which energy falls from the last one
    critical: int = 0

    def record(self, falling: int | None, time: float) -> None:
        """Enter an equilibrium with its number of directions in which energy falls, None where that is not known."""
        self.equilibria += 1
        if falling is None:
            self.unchecked += 1
            return
        self.critical += int(falling != self.falling)
        self.falling = falling
        if falling:
            self.first = self.first if self.unstable else time
            self.unstable += 1

    def __str__(self) -> str:
        if self.unstable:
            passed = (
                "one limit point or bifurcation" if self.critical == 1 else "limit points or bifurcations"
            )
            count = "" if self.critical == 1 else f"{self.critical} "
            return (
                f"unstable from the load parameter {self.first:.6g} on, in {self.unstable} load steps, "
                f"with {count}{passed} passed"
            )
        return "stability not checked" if self.unchecked else "stable"


def falling_directions(system: System, step: Any) -> int | None:
    """In how many directions the energy falls from the trial state of a static step; None where that is not known."""
    reported, exchanged = int(system.core.n_negative), bool(system.core.n_exchanged)
    if exchanged or reported < 0:
        return count_falling(system, step)
    if system.core.asymmetry() > lack_of_rounding(system):  # of the tangent whose factors were counted
        return None
    local = np.concatenate([f.element >= 0 for f in system.model.fields])
    left = int(np.sum(bears(system) & ~local)) - system.core.n_eliminated - system.core.n_lengths
    return judged(system, reported - left)


def judged(system: System, falling: int) -> int | None:
    """Gaps of facets have kinks where edges cross: in contact a falling direction may be one of the mesh alone."""
    touches = any(c.touches for c in system.components)
    return None if falling > 0 and touches else max(falling, 0)


def count_falling(system: System, step: Any) -> int | None:
    """The same by factors of the whole tangent, where it is symmetric and small."""
    if n_equations(system) > LARGEST:
        return None
    if not n_equations(system):
        return 0
    r, K = system.tangent(step)
    if not is_symmetric(system, K):
        return None
    moving = ~resting_unknowns(system)[system.free_unknowns]
    free, K = system.free_unknowns[moving], K[moving][:, moving]
    K = resisting(K, system.scale[free], r[free])
    element = system.local[free]  # these are as stiff or soft as their element makes them
    left = np.flatnonzero(element < 0)
    pressed = bears(system)[free][left]
    tiny = ROUNDING if pressed.any() or takes_differences(system) else NEUTRAL

    def count(largest: int) -> int | None:
        K_left, scale = condensed(K, element)[left][:, left], system.scale[free][left]
        pivots = pivots_of(K_left, pressed, scale, largest)
        return None if pivots is None else int(np.sum(pivots < -tiny)) - int(pressed.sum())

    falling = count(FULL)
    if falling and FULL < len(left) <= CONFIRMED:
        falling = count(CONFIRMED)
    return None if falling is None else judged(system, falling)


def resisting(K: sp.csr_array, scale: Array, r: Array) -> sp.csr_array:
    """A tangent without what comes of forces `r` (n,) that the iteration left out of balance.

    They turn what nothing else resists: rows of that alone would be scaled to one, and their signs counted. Each part
    that is coupled counts by its own forces: those left on a mountain say nothing of a beam beside it.
    """
    from scipy.sparse.csgraph import connected_components

    n_parts, part = connected_components(K, directed=False)
    left = np.zeros(n_parts)
    np.maximum.at(left, part, UNBALANCED * np.abs(r * scale))
    entries = K.tocoo()
    i, j = entries.coords
    moves = scale[i] * scale[j]
    entries.data = np.where((moves > 0) & (np.abs(entries.data) * moves <= left[part[i]]), 0.0, entries.data)
    return entries.tocsr()


def lack_of_rounding(system: System) -> float:
    """Differences across the diagonal of an equilibrated tangent, up to which they may be rounding.

    Loads that follow are far smaller than the stiffness of slender beams against stretching: nothing else is put down
    to rounding, unless functions of Python take part, whose derivatives may be differences.
    """
    return BY_DIFFERENCES if takes_differences(system) else UNSYMMETRIC


def takes_differences(system: System) -> bool:
    """Whether functions of Python take part, whose second derivatives may be differences."""
    model = system.model
    return bool(model.terms or model.functions) or any(e.law.callback for e in model.elements)


def is_symmetric(system: System, K: sp.csr_array) -> bool:
    """Whether every entry of a tangent is that across the diagonal, but for rounding."""
    size, _ = asymmetry(K)
    return size <= lack_of_rounding(system)


def bears(system: System) -> NDArray[np.bool_]:
    """Unknowns (n,) that stand for forces, multipliers and pressures: the energy is largest in them."""
    fields = system.model.fields
    return np.concatenate([~f.fixed & f.role.bears for f in fields])


def pivots_of(K: sp.csr_array, pressed: NDArray[np.bool_], scale: Array, full: int = FULL) -> Array | None:
    """Numbers (n,) with the signs of the eigenvalues of a symmetric matrix; None where they are not found.

    Matrices of up to `full` rows are factored with exchange of rows.
    """
    import scipy.sparse as sp

    s = equilibration(K, scale)
    compliance = np.where(pressed & (K.diagonal() == 0), COMPLIANCE, 0.0)
    if len(scale) <= full:
        return full_pivots(s[:, None] * K.toarray() * s - np.diag(compliance))
    return sparse_pivots(sp.diags_array(s) @ K @ sp.diags_array(s) - sp.diags_array(compliance))


def full_pivots(A: Array) -> Array:
    """Eigenvalues of the blocks, of one row or two, in the factors of Bunch and Kaufman."""
    from scipy.linalg import ldl

    _, D, _ = ldl(A)
    a, b, c = D.diagonal().copy(), np.append(D.diagonal(1), 0.0), np.append(D.diagonal()[1:], 0.0)
    k = np.flatnonzero(b)
    blocks = np.array([[a[k], b[k]], [b[k], c[k]]]).transpose(2, 0, 1)
    a[k], a[k + 1] = np.linalg.eigvalsh(blocks).T
    return np.asarray(a)


def sparse_pivots(A: sp.csr_array) -> Array | None:
    """Pivots without exchange of rows, None where one vanishes."""
    from scipy.sparse.linalg import splu

    options = {"SymmetricMode": True}
    try:
        lu = splu(A.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    except RuntimeError:
        return None
    return np.asarray(lu.U.diagonal()) if np.array_equal(lu.perm_r, lu.perm_c) else None


def instability(system: System, where: str, falling: int) -> str:
    """Message about an unstable equilibrium, with its first cure."""
    directions = "one direction" if falling == 1 else f"{falling} directions"
    return (
        f"the equilibrium {where} is unstable: energy falls in {directions}, so that the structure buckles or falls "
        f"over at the slightest disturbance{weak_elements(system)}. Disturb it, by a small load or an imperfect shape"
    )


def weak_elements(system: System) -> str:
    """Doubt about instabilities, where elements may have some of their own: modes that look like hourglasses."""
    weak = [
        f"{c.label} ({kind})"
        for c in system.components
        if isinstance(c, Solid) and (kind := c.formulation) in SUITED
    ]
    if not weak:
        return ""
    return (
        f", or elements do, which in {', '.join(weak)} may give way under strong compression where the structure would "
        "not (compare with formulation='displacement')"
    )
