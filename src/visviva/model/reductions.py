"""Unknowns that leave the equations before they are solved, as components know them."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(eq=False)
class Reductions:
    """Unknowns that others give.

    Attributes
    ----------
    rigid : list of list of int
        Unknowns of each rigid body: its position and directors (12), then the multipliers of its rigidity (6).
    slaves, directors : list of tuple of int
        Unknowns and multipliers of `eliminate` and `eliminate_director`.
    pressures : list of tuple of int
        Multipliers, first unknowns and sizes of `condense_multiplier`.
    """

    rigid: list[list[int]] = field(default_factory=list)
    slaves: list[tuple[int, int]] = field(default_factory=list)
    directors: list[tuple[int, int]] = field(default_factory=list)
    pressures: list[tuple[int, int, int]] = field(default_factory=list)

    def eliminate(self, unknown: int, multiplier: int) -> None:
        """Eliminate an unknown and a multiplier whose constraint, linear in the unknown, gives it by others.

        The constraint must be that of a term of its own, and linear in the multiplier too.
        """
        self.slaves.append((unknown, multiplier))

    def eliminate_director(self, unknown: int, multiplier: int) -> None:
        """Eliminate a multiplier that holds the length of the vector at three unknowns, and no more.

        The vector leaves with what of it is no motion on the sphere: two of its three unknowns stay.
        """
        self.directors.append((unknown, multiplier))

    def condense_multiplier(self, multiplier: int, unknown: int, size: int) -> None:
        """Eliminate a multiplier with the momentum equation of a node, its first unknown and how many it has.

        The multiplier's force must act on that node more than on those of other such multipliers; it may be no other
        one's.
        """
        self.pressures.append((multiplier, unknown, size))
