"""Contact and friction."""

from __future__ import annotations

from functools import partial
from typing import Any

from contact_parts import PYRAMID, bricks, edge_on_edge, overhanging, plates, rigid_on_brick
from point_contacts import SHAPES, balls, blocks, on_shape
from rubbing import thrown

import visviva as vv
from catalogue.entry import ALL, MOMENTA, PLANE_MOMENTA, Entry

CONTACTS: dict[str, Any] = {
    "dissipative": ({}, MOMENTA),
    "conserving": ({"impact": "conserving"}, ALL),
    "penalty": ({"enforcement": "penalty"}, ALL),
}
"""Ways to enforce contact, and what they conserve."""

ELASTIC: dict[str, Any] = {"enforcement": "penalty", "tangential": "penalty"}

PYRAMID_BODY = vv.SurfaceMesh(**PYRAMID)

HELD: dict[str, Any] = {
    "enforcement": "multipliers",
    "tangential": "multipliers",
    "initial": "press",
}
"""What overlaps at the start is pressed apart."""

CONTACT = [
    # contact
    Entry("blocks, vertices and facets", lambda: blocks(enforcement="penalty"), ALL, steps=40),
    Entry("contact, bricks that overhang", lambda: overhanging(enforcement="penalty"), ALL, 0.01, 40),
    Entry("blocks in the plane, vertices and facets", lambda: blocks(flat=True), ALL, steps=40),
    *(
        Entry(f"contact, {name}, {kind}", partial(make, **options), what, h=0.01, steps=30)
        for name, make in {"bricks": bricks, "plates": plates}.items()
        for kind, (options, what) in CONTACTS.items()
    ),
    *(
        Entry(f"contact, {name}, dual, {kind}", partial(make, **options), what, h=0.01, steps=30)
        for name, make in {"bricks": bricks, "plates": plates}.items()
        for kind, (options, what) in {
            "kept": ({"multipliers": "dual", "impact": "conserving"}, ALL),
            "condensed": ({"multipliers": "dual", "condensed": True, "impact": "conserving"}, ALL),
            "condensed, dissipative": ({"multipliers": "dual", "condensed": True}, MOMENTA),
        }.items()
    ),
    Entry(
        "contact, exact sphere, condensed",
        partial(on_shape, "sphere", condensed=True, impact="conserving"),
        ALL,
        h=0.01,
        steps=30,
    ),
    Entry("contact, tet4", partial(bricks, "tet4", impact="conserving"), ALL, h=0.01, steps=10),
    Entry("contact, quad8", partial(plates, "quad8", enforcement="penalty"), ALL, h=0.01, steps=10),
    Entry(
        "contact, rigid box",
        partial(rigid_on_brick, vv.Box(size=(0.8, 0.7, 0.4)), 0.22, enforcement="penalty"),
        ALL,
        h=0.01,
        steps=15,
    ),
    Entry(
        "contact, rigid triangles",
        partial(rigid_on_brick, vv.SurfaceMesh(**PYRAMID), 0.02, impact="conserving"),
        ALL,
        h=0.01,
        steps=15,
    ),
    Entry(
        "contact, rigid balls, restitution",
        partial(balls, away=0.15, enforcement="multipliers", tangential="multipliers", restitution=0.5),
        MOMENTA,
        0.01,
        60,
    ),
    *(
        Entry(f"contact, exact {name}, {kind}", partial(on_shape, name, **options), what, h=0.01, steps=30)
        for name in SHAPES
        for kind, (options, what) in CONTACTS.items()
        if kind != "dissipative" or name == "sphere"
    ),
    *(
        Entry(f"contact, rigid edges, {kind}", partial(edge_on_edge, **options), what, h=0.002, steps=40)
        for kind, (options, what) in (CONTACTS | {"friction": ({"friction": 0.3}, MOMENTA)}).items()
    ),
    # friction
    Entry("friction", thrown, MOMENTA, steps=20),
    Entry("friction, elastic", lambda: thrown(tangential="penalty", stiffness=60.0), MOMENTA, steps=20),
    Entry("friction, penalty", lambda: thrown(enforcement="penalty", stiffness=60.0), MOMENTA, steps=20),
    Entry("friction in the plane", lambda: thrown(2), PLANE_MOMENTA, steps=30),
    Entry("friction in the plane, elastic", lambda: thrown(2, tangential="penalty"), PLANE_MOMENTA, 0.01, 40),
    *(
        Entry(
            f"friction, vertices and facets, {kind}",
            partial(blocks, friction=0.3, **options),
            MOMENTA,
            steps=30,
        )
        for kind, options in {
            "multipliers": {},
            "elastic": {"enforcement": "penalty", "tangential": "penalty"},
            "in the plane": {"flat": True},
        }.items()
    ),
    *(
        Entry(
            f"friction, exact {name}", partial(on_shape, name, friction=0.3, **ELASTIC), MOMENTA, 0.0025, 100
        )
        for name in SHAPES
    ),
    Entry(
        "friction, exact sphere, multipliers", lambda: on_shape("sphere", friction=0.3), MOMENTA, 0.0025, 100
    ),
    Entry("friction, bricks that overhang", lambda: overhanging(friction=0.3, **ELASTIC), MOMENTA, 0.01, 40),
    Entry("friction of balls", balls, MOMENTA, 0.01, 30),
    *(
        Entry(
            f"friction of balls on facets, {kind}",
            partial(balls, PYRAMID_BODY, **options),
            MOMENTA,
            0.01,
            30,
        )
        for kind, options in {
            "elastic": {"away": 0.11},
            "slides": HELD,
            "sticks": {**HELD, "friction": 5.0},
        }.items()
    ),
]
