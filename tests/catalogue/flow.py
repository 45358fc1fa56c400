"""Fluids, and solids immersed in them."""

from __future__ import annotations

from functools import partial

from flow_parts import enclosed, stream, torus
from immersed_parts import body, flap, large, leaflet, strip

from catalogue.entry import NOTHING, Entry

FLOW = [
    # fluids
    *[
        Entry(f"stream, {cell}", partial(stream, cell), NOTHING, h=0.05, steps=20)
        for cell in ("quad4", "tri3", "quad9", "tri6", "hex8", "tet4", "hex27", "tet10")
    ],
    *[
        Entry(f"Stokes stream, {cell}", partial(stream, cell, convection=False), NOTHING, h=0.05, steps=20)
        for cell in ("quad4", "tri6", "tet4")
    ],
    *[
        Entry(f"enclosed flow, {cell}", partial(enclosed, cell), NOTHING, h=0.05, steps=20)
        for cell in ("quad4", "tri3", "quad9", "tri6", "hex8")
    ],
    *[
        Entry(f"periodic flow, {cell}", partial(torus, cell), NOTHING, h=0.05, steps=20)
        for cell in ("quad4", "tri3", "quad9", "tri6")
    ],
    # immersed solids
    *[
        Entry(f"immersed, {cell}", partial(large, cell), NOTHING, h=0.02, steps=10)
        for cell in ("quad4", "tri3", "quad9", "tri6", "hex8")
    ],
    *[
        Entry(f"immersed {kind}", partial(large, cell, kind=kind), NOTHING, h=0.02, steps=10)
        for cell, kinds in (
            ("quad4", ("tri3", "tri6", "quad8", "quad9")),
            ("hex8", ("tet4", "tet10", "hex20")),
        )
        for kind in kinds
    ],
    Entry("immersed, lighter", lambda: large("quad4", density=0.4), NOTHING, h=0.02, steps=10),
    Entry("immersed, damped", lambda: large("quad4", damping=0.1), NOTHING, h=0.02, steps=10),
    Entry("immersed, sealed", lambda: large("quad4", sealing=100.0), NOTHING, h=0.02, steps=10),
    Entry("immersed, enhanced", lambda: large("quad4", formulation="enhanced"), NOTHING, h=0.02, steps=10),
    # immersed rigid bodies
    *[
        Entry(f"immersed body, {cell}", partial(body, cell, 3, 10.0), NOTHING, h=0.02, steps=10)
        for cell in ("quad4", "tri6", "hex8")
    ],
    Entry("immersed body, lighter", lambda: body("quad9", 3, 10.0, density=0.4), NOTHING, h=0.02, steps=10),
    Entry("immersed body, damped", lambda: body("quad4", 3, 10.0, damping=0.1), NOTHING, h=0.02, steps=10),
    Entry("immersed, may leave", lambda: large("quad4", leaves=True), NOTHING, h=0.02, steps=10),
    Entry("immersed body, may leave", lambda: body("quad4", 3, 10.0, leaves=True), NOTHING, h=0.02, steps=10),
    Entry("immersed flap", lambda: flap("quad4", 3, 10.0), NOTHING, h=0.02, steps=10),
    Entry("immersed beam", strip, NOTHING, h=0.02, steps=10),
    Entry("immersed shell", leaflet, NOTHING, h=0.02, steps=10),
]
