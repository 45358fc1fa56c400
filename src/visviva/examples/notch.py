"""Notched plate: a square with a notch to its middle is pulled apart; the crack that runs from there snaps back.

Miehe, Hofacker & Welschinger (2010): 1 mm x 1 mm of steel with Gc = 2.7 N/mm and l = 0.015 mm, AT2, in plane strain;
kN and mm. Their load steps jump from the peak, digitised at 0.7012 kN and 0.00555 mm, to nothing. Steps of load and
crack together follow the path between, on which the plate has to be let go for a while.
"""

from __future__ import annotations

import numpy as np

import visviva as vv

PEAK = 0.7012


def lines(fine_from: float, fine_to: float, fine: float, coarse: float = 0.05) -> np.ndarray:
    """Places 0 ... 1 of lines, of a `fine` distance in a part, growing by a fifth from line to line outside."""
    inner = np.linspace(fine_from, fine_to, max(1, round((fine_to - fine_from) / fine)) + 1)

    def outwards(gap: float) -> np.ndarray:
        sizes: list[float] = []
        size = fine
        while sum(sizes) < gap - 1e-12:
            size = min(1.2 * size, coarse)
            sizes.append(size)
        return np.cumsum(sizes) * (gap / sum(sizes) if sizes else 1.0)

    return np.concatenate([fine_from - outwards(fine_from)[::-1], inner, fine_to + outwards(1 - fine_to)])


def notched(x: np.ndarray, y: np.ndarray, tip: float, level: float) -> vv.Mesh:
    """Quadrilaterals between lines, cut open at a level from the left to a tip."""
    unit = vv.RectangleMesh(size=(1, 1), counts=(len(x) - 1, len(y) - 1)).build()
    i, j = np.rint(unit.points * (len(x) - 1, len(y) - 1)).astype(int).T
    mesh = vv.Mesh(np.stack([x[i], y[j]], axis=1), unit.cells, face_sets=unit.face_sets)
    near = 1e-9 * float(np.ptp(x))
    return mesh.opened(
        lambda X: (np.abs(X[:, 1] - level) < near) & (X[:, 0] < tip - near), lambda X: X[:, 1] > level
    )


def study(
    size: float = 0.0075, length: float = 0.015, step: float = 2e-4, growth: float = 0.02, until: float = 0.1
) -> vv.Study:
    """Cells of `size` where the crack runs; steps by a displacement `step` and a `growth` of the crack."""
    half = round(0.04 / size) * size
    plate = vv.FracturingSolid(
        mesh=notched(lines(0.5, 1, size), lines(0.5 - half, 0.5 + half, size), 0.5, 0.5),
        material=vv.SaintVenantKirchhoff(young=210.0, poisson=0.3),
        toughness=2.7e-3,
        length=length,
        name="plate",
    )
    held = vv.Fixed(solid=plate, nodes="y0", name="held")
    moved = vv.Prescribed(solid=plate, nodes="y1", motion=(0, "t", None), name="moved")
    probes = {
        "force": vv.SupportForce(solid=plate, nodes="y1"),
        "crack": vv.CrackArea(solid=plate),
        "tip": vv.CrackTip(solid=plate, along=(1, 0, 0)),
    }
    scheme = vv.CrackControl(growth=growth, unstable=True, most=120)
    system = vv.System([plate, held, moved])
    fields = ("damage", "von_mises")
    return vv.Study(system, until, step, scheme, probes, fields=fields, title="Notched plate", notes=__doc__)


def check(result: vv.Result) -> None:
    """The peak is that of the paper within 5 %, and the path snaps back from it, with the energy in balance."""
    (plate,) = (c for c in result.system.components if isinstance(c, vv.FracturingSolid))
    if plate.length > 0.016 or plate.crack_energy(result.states[-1]) < 0.2 * plate.toughness:
        return
    top = plate.nodes("y1")
    force = [-plate.nodal_forces(x)[top, 1].sum() for x in result.states]
    np.testing.assert_allclose(max(force), PEAK, rtol=0.05)
    assert (np.diff(result.times) < 0).any()
    assert result.conservation()["energy"] < 5e-3
