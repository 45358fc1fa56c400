"""Misfit: a round soft particle, larger than a critical size, grows long by diffusion that its stress drives.

Elastic energy of a soft particle with misfit falls as it grows long, that of its interface rises, so that beyond a
critical radius the ellipse wins (Johnson & Cahn 1984; Jog, Sankarasubramanian & Abinandanan 2000): a pitchfork, after
which the aspect rises steeply. Energies of ellipses are Eshelby's, in an infinite plane, of sharp interfaces. A quarter
is computed, in a frame without diffusion, stress in balance while diffusion marches. Lengths are by that radius, times
by the cube of it over mobility and surface energy.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.special import ellipe

import visviva as vv

Array = NDArray[np.float64]
E, NU, ETA, SOFTNESS = 100.0, 0.3, 0.01, 0.5
LONGEST = 3.0
"""Logarithm of the longest aspect that is looked for."""


def eshelby(aspect: float, softness: float) -> float:
    """Elastic energy of an ellipse of unit area in an infinite plane, with the eigenstrain (eta, eta, 0).

    By the equivalent inclusion: ``Cp (S e - e*) = Cm (S e - e)``, energy ``- e* . Cp (S e - e*) / 2``.
    """
    a, b, q = aspect**0.5, aspect**-0.5, 1 / (2 * (1 - NU))
    s = a + b
    S = q * np.array(
        [
            [
                (b * b + 2 * a * b) / s**2 + (1 - 2 * NU) * b / s,
                b * b / s**2 - (1 - 2 * NU) * b / s,
                2 * NU * b / s,
            ],
            [
                a * a / s**2 - (1 - 2 * NU) * a / s,
                (a * a + 2 * a * b) / s**2 + (1 - 2 * NU) * a / s,
                2 * NU * a / s,
            ],
            [0.0, 0.0, 0.0],
        ]
    )
    lam, mu = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
    C = lam + 2 * mu * np.eye(3)
    misfit = np.array([ETA, ETA, 0.0])
    equivalent = np.linalg.solve(softness * C @ S - C @ (S - np.eye(3)), softness * C @ misfit)
    stress = softness * C @ (S @ equivalent - misfit)
    return float(-0.5 * stress @ misfit)


def perimeter(aspect: float) -> float:
    """Of an ellipse of the area pi."""
    return float(4 * aspect**0.5 * ellipe(1 - aspect**-2.0))


def critical(softness: float) -> float:
    """Surface energy by the radius at which the round shape gives way, from second differences about it."""
    step = 0.02
    elastic, surface = (
        f(np.exp(step)) + f(np.exp(-step)) - 2 * f(1.0)
        for f in (lambda a: np.pi * eshelby(a, softness), perimeter)
    )
    return float(-elastic / surface)


def best_aspect(ratio: float, softness: float) -> float:
    """Aspect of least energy of an ellipse whose area is that of a circle of `ratio` critical radii."""
    tension = critical(softness)

    def energy(t: float) -> float:
        return tension * perimeter(np.exp(t)) + ratio * np.pi * eshelby(np.exp(t), softness)

    return float(np.exp(minimize_scalar(energy, bounds=(0.0, LONGEST), method="bounded").x))


def frame_mesh(inner: float, count: int, outer: float = 20.0) -> vv.Mesh:
    """A quarter of a plate around the quarter of a square of `count` cells, whose own grow outwards."""
    sizes = [inner / count] * count
    while sum(sizes) < outer:
        sizes.append(1.2 * sizes[-1])
    lengths = tuple(sizes)
    grid = vv.RectangleMesh(
        size=(sum(sizes),) * 2, counts=(len(sizes),) * 2, grading=(lengths, lengths)
    ).build()
    cells = {"quad4": grid.cells["quad4"][grid.centres.max(axis=1) > inner]}
    near = 1e-9 * outer
    mesh = vv.Mesh(grid.points, cells).without_orphans()
    mesh = mesh.with_nodes("x0", lambda X: X[:, 0] < near).with_nodes("y0", lambda X: X[:, 1] < near)
    return mesh.with_faces("inside", lambda X: X[:, :2].max(axis=1) < inner + near)


def study(
    ratio: float = 1.5,
    width: float = 0.25,
    aspect: float = 1.2,
    inner: float = 4.0,
    cells: float = 2.1,
    until: float = 3.0,
) -> vv.Study:
    """A particle of `ratio` critical radii from an `aspect` on, in a square of half the edge `inner`.

    Interfaces have a `width` with so many `cells` across.
    """
    tension, h = critical(SOFTNESS), width / cells
    barrier = 12 * tension / width
    excess = (tension / ratio + eshelby(1.0, SOFTNESS)) / (2 * barrier)
    low = excess * (1 + 3 * excess)  # the potential of the round particle, by Gibbs & Thomson
    long, high = ratio * aspect**0.5, ratio * aspect**-0.5
    count = round(inner / h)
    square = vv.RectangleMesh(size=(inner, inner), counts=(count, count)).build()
    mesh = square.with_faces("outside", lambda X: X[:, :2].max(axis=1) > inner - 1e-9)

    def composition(X: Array) -> Array:
        x, y = X[:, 0] / long, X[:, 1] / high
        r = np.hypot(x, y) + 1e-12
        distance = (r - 1) * r / np.hypot(x / long, y / high).clip(1e-9)
        return np.asarray(low + (1 - low) * (0.5 - 0.5 * np.tanh(2 * distance / width)))

    alloy = vv.MixtureSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=E, poisson=NU),
        free_energy=vv.DoubleWell(barrier=barrier, low=0.0, high=1.0),
        gradient_energy=barrier * width**2 / 8,
        mobility=1 / tension,
        concentration=composition,
        eigenstrain=(ETA, ETA, 0.0),
        reference=low,
        moduli=(SOFTNESS - 1,),
        name="alloy",
    )
    frame = vv.Solid(mesh=frame_mesh(inner, count), material=alloy.material, name="frame")
    tie = vv.Tie(first=alloy, first_faces="outside", second=frame, second_faces="inside")
    planes = [
        vv.SymmetryPlane(solid=solid, nodes=side, normal=np.eye(3)[k], name=f"{solid.name} {side}")
        for k, side in enumerate(("x0", "y0"))
        for solid in (alloy, frame)
    ]
    return vv.Study(
        vv.System([alloy, frame, tie, *planes]),
        until,
        1e-3,
        vv.BackwardEuler(),
        probes={
            "particle": vv.PhaseVolume(body=alloy, above=0.5),
            "interface": vv.InterfaceArea(body=alloy, phases=(0, 1)),
        },
        fields=("concentration", "von_mises"),
        adaptive=vv.Adaptive(tolerance=2e-2, max_step=2.0),
        title="Particle with misfit",
        notes=__doc__,
    )


def shape(alloy: vv.MixtureSolid, x: Array) -> tuple[float, float]:
    """Radius of the circle as large as the particle, by the critical one, and aspect, where the axes cross its edge."""
    c, X = alloy.values(x), alloy.points
    half = 0.5 * (c.max() + c.min())
    crossings = []
    for axis in (0, 1):
        on = np.flatnonzero(X[:, 1 - axis] < 1e-9)
        on = on[np.argsort(X[on, axis])]
        crossings.append(np.interp(-half, -c[on], X[on, axis]))
    a, b = crossings
    return float(np.sqrt(a * b)), float(a / b)


def check(result: vv.Result) -> None:
    """The energy falls and the amounts stay; small particles become rounder, large ones long, if less than ellipses."""
    (alloy,) = (c for c in result.system.components if isinstance(c, vv.MixtureSolid))
    assert np.all(np.diff(result.ledger["potential_stored"]) < 1e-12)
    amounts = [alloy.integral(x) for x in (result.states[0], result.states[-1])]
    np.testing.assert_allclose(amounts[0], amounts[1], rtol=1e-9)
    (_, start), (radius, aspect) = (shape(alloy, x) for x in (result.states[0], result.states[-1]))
    if result.times[-1] < 1.5 or 1.0 < radius < 1.4:
        return
    assert 1.3 * start < aspect < best_aspect(radius, SOFTNESS) if radius > 1 else 1 <= aspect < 0.9 * start
