"""Quenched plate: a hot plate of a ceramic is cooled at its surface; cracks grow inwards, fewer the deeper they are.

After Bourdin, Marigo, Maurini & Sicsic (2014), of whose slab this is a part: E = 340 GPa, nu = 0.22, Gc = 42.47 J/m2,
expansion 8e-6 / K, cooled by 380 K at once, AT1 in plane strain; N and mm. Temperatures are those of a half-space at a
depth of heat ``2 sqrt(kappa t)``, by which time is told here, once the first such depth has come. Their length of
0.046 mm is twice as large by default.
"""

from __future__ import annotations

import numpy as np
from scipy.special import erfc

import visviva as vv

YOUNG, POISSON, TOUGHNESS, EXPANSION, DROP = 340e3, 0.22, 42.47e-3, 8e-6, 380.0
RISE = 4
"""Load steps over which the first depth of heat comes."""


def study(
    width: float = 4.0,
    depth: float = 1.6,
    length: float = 0.1,
    cells: float = 2.0,
    until: float = 0.76,
    step: float = 0.04,
) -> vv.Study:
    """`cells` per length everywhere; the surface is y = 0, and depths of heat grow by `step` after the first ones."""
    counts = round(width * cells / length), round(depth * cells / length)
    mesh = vv.RectangleMesh(size=(width, depth), counts=counts)
    rng = np.random.default_rng(1)

    # what jumps at the start comes over some load steps: one alone does not resolve its work
    def strain(t: float, X: np.ndarray) -> np.ndarray:
        share, heat = min(t / (RISE * step), 1.0), max(t - (RISE - 1) * step, step)
        return np.asarray(-EXPANSION * DROP * share * erfc(X[:, 1] / heat))

    plate = vv.FracturingSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=YOUNG, poisson=POISSON),
        toughness=TOUGHNESS,
        length=length,
        model="AT1",
        damage=lambda X: 0.02 * rng.uniform(size=len(X)),  # nothing else tells one place from another
        free_strain=strain,
        name="plate",
    )
    held = [
        vv.SymmetryPlane(solid=plate, nodes=nodes, normal=normal, name=nodes)
        for nodes, normal in (("x0", (1, 0, 0)), ("x1", (1, 0, 0)), ("y1", (0, 1, 0)))
    ]
    probes = {"crack": vv.CrackArea(solid=plate), "deepest": vv.CrackTip(solid=plate, along=(0, 1, 0))}
    scheme = vv.AlternateMinimization(unstable=True, energy_tolerance=1e-5, newton=20)
    system = vv.System([plate, *held])
    fields = ("damage", "von_mises")
    return vv.Study(system, until, step, scheme, probes, fields=fields, title="Quenched plate", notes=__doc__)


def count(plate: vv.FracturingSolid, x: np.ndarray, depth: float) -> int:
    """Cracks at a depth."""
    level = plate.points[np.argmin(np.abs(plate.points[:, 1] - depth)), 1]
    row = np.flatnonzero(np.abs(plate.points[:, 1] - level) < 1e-9)
    d = plate.damages(x)[row[np.argsort(plate.points[row, 0])]] > 0.8
    return int(np.sum(d[1:] & ~d[:-1]) + d[0])


def check(result: vv.Result) -> None:
    """Several cracks start, and fewer of them are deep."""
    (plate,) = (c for c in result.system.components if isinstance(c, vv.FracturingSolid))
    if not 0.72 <= result.times[-1] < 0.78:
        return
    x = result.states[-1]
    shallow, deep = count(plate, x, 4 * plate.length), count(plate, x, 7 * plate.length)
    assert shallow >= 3
    assert 1 <= deep < shallow
