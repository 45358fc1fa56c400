"""Bodies with few vertices, between which others fit."""

from __future__ import annotations

from typing import Any

import pytest

import visviva as vv


def start(parts: list[Any], cure: str | None) -> None:
    """A step is taken, or refused with the cure of what fits between vertices."""
    system = vv.System(parts)
    if cure is None:
        vv.simulate(system, until=1e-4, step=1e-4)
        return
    with pytest.raises(vv.InputError, match=rf"fits between the vertices of .* {cure}"):
        vv.simulate(system, until=1e-4, step=1e-4)


def coarse_plate(shell: bool = False) -> Any:
    """Nodes half a length apart."""
    if shell:
        sheet = vv.HomogeneousSection(young=1e6, poisson=0.3, thickness=0.1, density=1e3)
        return vv.Shell(
            mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 1), origin=(0, 0, -1.05)).build().surface("z1"),
            section=sheet,
        )
    mesh = vv.BoxMesh(size=(1, 1, 0.2), counts=(2, 2, 1), origin=(0, 0, -0.2))
    return vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e6, poisson=0.3), density=1e3)


def bar(count: int, **options: Any) -> vv.Beam:
    """A bar 1 m long with this many cells."""
    line = vv.LineMesh(points=[(-0.5, 0, 0), (0.5, 0, 0)], count=count)
    return vv.Beam(mesh=line, section=vv.TubeSection(radius=0.02, young=1e7, density=1e3), **options)
