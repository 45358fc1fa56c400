"""Tiny instances of the other fields."""

from __future__ import annotations

from instances.heat import Bar
from instances.immersed import ImmersedSolid
from instances.solid import Brick
from instances.stokes import StokesCell
from instances.twisted import TwistedBeam

from catalogue.entry import ALL, ENERGY, NOTHING, Entry

INSTANCES = [
    Entry("solid brick", lambda: [Brick()], ALL, steps=100, analytic=False),
    Entry("solid brick, held", lambda: [Brick(fixed=True)], ENERGY, steps=50, analytic=False),
    Entry("heat bar", lambda: [Bar()], NOTHING, analytic=False),
    Entry("twisted beam", lambda: [TwistedBeam()], ALL, steps=100),
    Entry("stokes cell", lambda: [StokesCell()], NOTHING),
    Entry("immersed solid", lambda: [ImmersedSolid()], ENERGY, steps=50, analytic=False),
]
