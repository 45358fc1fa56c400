"""Tiny instances of the other fields."""

from __future__ import annotations

from instances import points
from instances.heat import Bar
from instances.immersed import ImmersedSolid
from instances.solid import Brick
from instances.stokes import StokesCell
from instances.twisted import TwistedBeam

from catalogue.entry import ALL, ENERGY, MOMENTA, NOTHING, Entry

INSTANCES = [
    Entry("solid brick", lambda: [Brick()], ALL, steps=100, analytic=False),
    Entry("solid brick, held", lambda: [Brick(fixed=True)], ENERGY, steps=50, analytic=False),
    Entry("heat bar", lambda: [Bar()], NOTHING, analytic=False),
    Entry("twisted beam", lambda: [TwistedBeam()], ALL, steps=100),
    Entry("stokes cell", lambda: [StokesCell()], NOTHING),
    Entry("viscoelastic points", lambda: [points.Viscoelastic()], MOMENTA, steps=60),
    Entry(
        "viscoelastic points of the user",
        lambda: [points.UserViscoelastic()],
        MOMENTA,
        steps=30,
        analytic=False,
    ),
    Entry("thermoelastic points", lambda: [points.Thermoelastic()], ALL, steps=60),
    Entry("damage points", lambda: [points.Damaged()], MOMENTA, steps=60),
    Entry("separating points", lambda: [points.Separating()], NOTHING, steps=60),
    Entry("director beam", lambda: [points.DirectorBeam()], ALL, steps=100),
    Entry("director beam, clamped", lambda: [points.DirectorBeam(clamped=True)], ENERGY, steps=100),
    Entry("director shell", lambda: [points.DirectorShell()], ALL, steps=60),
    Entry("immersed solid", lambda: [ImmersedSolid()], ENERGY, steps=50, analytic=False),
]
