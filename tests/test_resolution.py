"""Modes of slender and thin bodies: right as long as double precision holds their frequencies, else refused by name."""

from __future__ import annotations

from copy import deepcopy

import numpy as np
import pytest

import visviva as vv

YOUNG, DENSITY = 210e9, 1000.0
CANTILEVER = np.array([1.87510407, 1.87510407, 4.69409113, 4.69409113]) ** 2
FREE = np.array([4.73004074, 4.73004074]) ** 2


def wire(slenderness: float, length: float, *, is_held: bool = True, cells: int = 8) -> vv.System:
    section = vv.TubeSection(radius=slenderness * length, young=YOUNG, poisson=0.3, density=DENSITY)
    end = tuple(length * np.array([1.0, 2.0, 2.0]) / 3)
    mesh = vv.LineMesh(points=[(0, 0, 0), end], count=cells, cell="line3")
    beam = vv.Beam(mesh=mesh, section=section)
    return vv.System([beam, vv.Clamped(solid=beam, nodes="start")] if is_held else [beam])


def bernoulli(slenderness: float, length: float) -> float:
    return float(np.sqrt(YOUNG / DENSITY) * slenderness / 2 / length)


def strip(thickness: float) -> vv.System:
    section = vv.HomogeneousSection(thickness=thickness, young=1e9, poisson=0.0, density=DENSITY)
    mesh = vv.RectangleMesh(size=(1, 0.2), counts=(6, 1), cell="quad9")
    shell = vv.Shell(mesh=mesh, section=section)
    return vv.System([shell, vv.Clamped(solid=shell, nodes="x0")])


@pytest.mark.parametrize("length", [10.0, 1.0, 1e-6])
@pytest.mark.parametrize("slenderness", [1e-3, 3e-5, 1e-5])
def test_slender_cantilevers_vibrate_like_bernoullis(slenderness: float, length: float) -> None:
    found = vv.modes(wire(slenderness, length), 4).angular / bernoulli(slenderness, length)
    assert found == pytest.approx(CANTILEVER, rel=3e-3)


def test_thin_strip_vibrates_like_bernoullis() -> None:
    found = vv.modes(strip(1e-5), 1).angular / np.sqrt(1e9 * 1e-10 / 12 / DENSITY)
    assert found == pytest.approx(CANTILEVER[:1], rel=1e-3)


def test_free_wire_moves_rigidly_and_bends() -> None:
    modes = vv.modes(wire(1e-4, 1.0, is_held=False), 8)
    assert modes.squared[:6].tolist() == [0.0] * 6
    assert modes.angular[6:] / bernoulli(1e-4, 1.0) == pytest.approx(FREE, rel=1e-3)


@pytest.mark.parametrize("length", [10.0, 1e-6])
@pytest.mark.parametrize("slenderness", [2e-6, 1e-6, 1e-8])
def test_what_rounding_hides_is_refused(slenderness: float, length: float) -> None:
    with pytest.raises(vv.InputError, match="Beam 'beam-1' is lost in rounding"):
        vv.modes(wire(slenderness, length), 4)


@pytest.mark.parametrize("slenderness", [1e-6, 1e-8])
@pytest.mark.parametrize("spins", [False, True])
def test_what_rounding_hides_is_refused_after_steps_too(slenderness: float, *, spins: bool) -> None:
    """A step of dynamics makes no zero of it; a sheet likewise."""
    wires, sheet = spinning(slenderness) if spins else wire(slenderness, 1.0), strip(1e-7)
    for system, label in ((wires, "Beam 'beam-1'"), (sheet, "Shell 'shell-1'")):
        vv.simulate(system, until=1e-9, step=1e-9)
        with pytest.raises(vv.InputError, match=f"{label} is lost in rounding"):
            vv.modes(system, 2)


@pytest.mark.parametrize("load", [1 - 1e-5, 1.0, 1 + 1e-5])
def test_zero_is_the_answer_at_the_critical_load(load: float) -> None:
    """Euler's, of a wire whose other squares stay, and whose least would be lost without the load's stress."""
    beam = deepcopy(wire(1e-3, 1.0)["beam-1"])
    end = np.array([1.0, 2.0, 2.0]) / 3
    force = -load * end * np.pi**2 / 4 * YOUNG * np.pi / 4 * 1e-12
    push = vv.Force(on=beam, at=tuple(end), force=tuple(force), times="t")
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), push])
    vv.quasi_static(system, until=1.0, step=1.0, scheme=vv.Static(unstable=True))
    squared = vv.modes(system, 4).squared / bernoulli(1e-3, 1.0) ** 2
    assert np.abs(squared[:2]).max() < 1e-4 * CANTILEVER[0] ** 2
    assert squared[2:].min() > 100


def test_thin_sheets_and_coarse_meshes_are_refused_too() -> None:
    with pytest.raises(vv.InputError, match="Shell 'shell-1' is lost in rounding"):
        vv.modes(strip(1e-7), 2)
    with pytest.raises(vv.InputError, match="Beam 'beam-1' is lost in rounding"):
        vv.modes(wire(1e-8, 1.0, cells=1), 3)


def test_two_parts_of_one_body_are_free_one_by_one() -> None:
    cube = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build()
    points = np.concatenate([cube.points, cube.points + np.array([3.0, 0.0, 0.0])])
    cells = np.concatenate([cube.cells["hex8"], cube.cells["hex8"] + len(cube.points)])
    solid = vv.Solid(
        mesh=vv.Mesh(points, {"hex8": cells}), material=vv.NeoHooke(young=1.0, poisson=0.3), density=1.0
    )
    squared = vv.modes(vv.System([solid]), 14).squared
    assert squared[:12].tolist() == [0.0] * 12
    assert squared[12] > 0.1


@pytest.mark.parametrize("n", [1, 2, 3, 5, 6])
def test_what_grows_is_found_beside_what_rounding_nearly_hides(n: int) -> None:
    """A pendulum on its head, by -g / l, is the lowest mode, and farther from zero than those of a wire."""
    wires = deepcopy(wire(1e-5, 1.0)["beam-1"])
    ground, top = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 3, 2))
    rod = vv.Distance(a=ground.point((0, 3, 0)), b=top.point())
    push = vv.Force(on=top, force=(0, 0, -3.0))
    system = vv.System([wires, vv.Clamped(solid=wires, nodes="start"), ground, top, rod, push])
    modes, unit = vv.modes(system, n), bernoulli(1e-5, 1.0)
    exact = [-1.5, -1.5, *(CANTILEVER * unit) ** 2][:n]
    assert not modes.stable
    assert modes.squared == pytest.approx(exact, rel=3e-3)


def spinning(slenderness: float) -> vv.System:
    """The wire, seen from a frame that turns about it a tenth as fast as it vibrates."""
    beam = deepcopy(wire(slenderness, 1.0)["beam-1"])
    rate = 0.1 * CANTILEVER[0] * bernoulli(slenderness, 1.0)
    frame = vv.RotatingFrame(angular_velocity=rate * np.array([1.0, 2.0, 2.0]) / 3)
    return vv.System([beam, vv.Clamped(solid=beam, nodes="start"), frame])


@pytest.mark.parametrize("slenderness", [1e-6, 1e-8])
def test_what_rounding_hides_is_refused_in_what_spins_too(slenderness: float) -> None:
    with pytest.raises(vv.InputError, match="Beam 'beam-1' is lost in rounding"):
        vv.modes(spinning(slenderness), 2)


@pytest.mark.parametrize("slenderness", [1e-3, 1e-5])
def test_what_spins_about_its_axis_vibrates_backward_and_forward(slenderness: float) -> None:
    """Slower and faster by the spin; growth that is rounding is none."""
    modes = vv.modes(spinning(slenderness), 2)
    assert modes.stable
    first = CANTILEVER[0] * bernoulli(slenderness, 1.0)
    assert modes.angular / first == pytest.approx([0.9, 1.1], rel=3e-3)
