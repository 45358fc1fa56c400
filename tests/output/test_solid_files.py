"""Solids in the trajectory file, as VTK's own reader and filters see them."""

import signal
import subprocess
import sys

import numpy as np
import pytest

import visviva as vv
from output.scenes import read_by_vtk
from visviva.output import Surface, Trajectory, TrajectoryWriter
from visviva.output.skin import skin
from visviva.results.drawing import Drawing
from visviva.results.result import Kept
from visviva.study.run import run

STEEL = vv.LinearElastic(young=200.0, poisson=0.25)
SPACE = ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6"]
PLANE = ["tri3", "tri6", "quad4", "quad8", "quad9"]
TENSOR = [[0, 3, 5], [3, 1, 4], [5, 4, 2]]


def block(cell):
    """A distorted block, or a plate, of cells of a type."""
    if cell in SPACE:
        mesh = vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 2), cell=cell).build()
    else:
        mesh = vv.RectangleMesh(size=(2, 1), counts=(2, 2), cell=cell).build()
    sheared = mesh.points + 0.1 * mesh.points[:, [1, 0, *range(2, mesh.dimension)]]
    return vv.Solid(mesh=vv.Mesh(sheared, mesh.cells), material=STEEL, density=1.0, name=cell)


def stretched(solid, system, gradient):
    """Unknowns of the affine motion F X, with F (d, d)."""
    x = system.x.copy()
    x[solid.motion.start : solid.motion.start + solid.motion.size] = (solid.grid.points @ gradient.T).ravel()
    return x


@pytest.mark.parametrize("cell", SPACE + PLANE)
def test_every_cell_type_is_a_cell_of_vtk(tmp_path, cell):
    """Volumes, gradients of the motion and orientation as VTK computes them from the file."""
    solid = block(cell)
    system, d = vv.System([solid]), solid.dimension
    F = np.eye(d) + 0.1 * np.arange(d * d).reshape(d, d)
    drawing = Drawing(system)
    with TrajectoryWriter(tmp_path / "t.vtkhdf", drawing.surfaces) as writer:
        for time, x in ((0.0, system.x), (1.0, stretched(solid, system, F))):
            writer.append(time, drawing.points(x), drawing.values(x, system.v))
    times, (before, after) = read_by_vtk(tmp_path / "t.vtkhdf")
    assert list(times) == [0.0, 1.0]
    size = "Volume" if d == 3 else "Area"
    total = before.compute_cell_sizes()[size].sum()
    assert total == pytest.approx(solid.grid.volume, rel=1e-6)
    assert after.compute_cell_sizes()[size].sum() == pytest.approx(np.linalg.det(F) * total, rel=1e-6)
    np.testing.assert_allclose(after["displacement"], after.points - before.points, atol=1e-15)
    before["displacement"] = after["displacement"]
    gradient = before.compute_derivative("displacement")["gradient"].reshape(-1, 3, 3)[:, :d, :d]
    np.testing.assert_allclose(gradient, np.broadcast_to(F - np.eye(d), gradient.shape), atol=1e-6)


def test_linear_stress_in_the_file_is_exact(tmp_path):
    """Hooke's law by hand, through the file of a run."""
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(2, 1, 1), counts=(2, 2, 2), cell="hex20"), material=STEEL, density=1.0
    )
    ball = vv.RigidBody(shape=vv.Sphere(radius=0.1), density=1.0, position=(0, 0, 3), velocity=(1, 0, 0))
    system = vv.System([ball, solid])
    H = np.array([[0.02, 0.01, 0.0], [0.0, -0.01, 0.03], [0.01, 0.0, 0.0]])
    x = stretched(solid, system, np.eye(3) + H)
    result = vv.simulate(system, until=0.1, step=0.1)
    result.kept = Kept([0.0], [x], [0.5 * system.v], [[]])
    result.write(tmp_path / "t.vtkhdf")
    _, (grid,) = read_by_vtk(tmp_path / "t.vtkhdf")
    e, mu, lam = (H + H.T) / 2, 80.0, 80.0
    sigma = 2 * mu * e + lam * np.trace(e) * np.eye(3)
    deviator = sigma - np.trace(sigma) / 3 * np.eye(3)
    filled = np.arange(grid.n_points) >= grid.n_points - solid.grid.n_nodes
    assert np.isnan(grid["cauchy"][~filled]).all()
    cauchy = grid["cauchy"][filled]
    np.testing.assert_allclose(
        cauchy[:, TENSOR], np.broadcast_to(sigma, (len(cauchy), 3, 3)), rtol=1e-11, atol=1e-11
    )
    np.testing.assert_allclose(grid["von_mises"][filled], np.sqrt(1.5 * np.sum(deviator**2)), rtol=1e-11)
    np.testing.assert_allclose(grid["pressure"][filled], -np.trace(sigma) / 3, rtol=1e-11)
    np.testing.assert_allclose(grid["energy"][filled], np.sum(sigma * e) / 2, rtol=1e-11)
    np.testing.assert_allclose(
        grid["velocity"][~filled], np.tile([0.5, 0, 0], (np.sum(~filled), 1)), atol=1e-12
    )


def test_surfaces_and_fields_read_back(tmp_path):
    solids = [block(cell) for cell in ("hex8", "tet10", "hex8", "quad8")]
    for k, solid in enumerate(solids):
        solid.name = f"part {k}"
    system = vv.System(solids)
    drawing = Drawing(system, fields=["stretches"])
    with TrajectoryWriter(tmp_path / "t.vtkhdf", drawing.surfaces) as writer:
        writer.append(0.0, drawing.points(system.x), drawing.values(system.x, system.v))
        writer.append(1.0, drawing.points(1.5 * system.x), drawing.values(1.5 * system.x, system.v))
    with Trajectory(tmp_path / "t.vtkhdf") as motion:
        assert motion.fields == {"displacement": 3, "stretches": 3, "velocity": 3}
        for ours, theirs in zip(drawing.surfaces, motion.surfaces, strict=True):
            assert (ours.name, ours.types) == (theirs.name, theirs.types)
            for mine, other in zip(ours.cells, theirs.cells, strict=True):
                np.testing.assert_array_equal(mine, other)
        for part in motion.field_at("stretches", 0.5)[:3]:
            np.testing.assert_allclose(part, (1 + np.sqrt(2)) / 2, rtol=1e-12)  # small strains: C = I + 2 e
        with pytest.raises(
            vv.InputError, match="no field is called 'stress'; there are displacement, stretches"
        ):
            motion.field("stress", 0)
    with pytest.raises(vv.InputError, match="von_mises"):
        Drawing(system, fields=["von_mieses"])


@pytest.mark.parametrize("cell", SPACE + PLANE)
def test_skin_is_closed_and_has_the_area(cell):
    solid = block(cell)
    surface = Surface(
        "s", solid.points, list(solid.grid.cells.values()), Drawing(vv.System([solid])).surfaces[0].types
    )
    faces = skin(surface)
    corners = [(solid.points[f[:, [0, k, k + 1]]]) for f in faces for k in range(1, f.shape[1] - 1)]
    oriented = [np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]) / 2 for c in corners]
    area = sum(np.linalg.norm(a, axis=1).sum() for a in oriented)
    if solid.dimension == 2:
        assert area == pytest.approx(solid.grid.volume, rel=1e-12)
    else:
        assert area == pytest.approx(solid.grid.boundary().area(solid.grid.points), rel=1e-12)
        assert np.abs(sum(a.sum(axis=0) for a in oriented)).max() < 1e-12
        outward = sum(np.einsum("fi,fi->", a, c.mean(axis=1)) for a, c in zip(oriented, corners, strict=True))
        assert outward / 3 == pytest.approx(solid.grid.volume, rel=1e-12)  # Gauss's theorem


RUN = """
import sys, visviva as vv
from visviva.study.run import run
rubber = vv.NeoHooke(young=1e3, poisson=0.3)
mesh = vv.BoxMesh(size=(2, 1, 1), counts=(4, 2, 2))
block = vv.Solid(mesh=mesh, material=rubber, density=1.0, angular_velocity=(1, 2, 3), name="block")
study = vv.Study(vv.System([block]), until=10.0, step=0.01)
study.probes = {"told": lambda system: print(system.time, flush=True) or 0.0}
run(study, sys.argv[1], progress=False, frames_per_second=1e9)
"""


@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGINT])
def test_interrupted_run_of_a_solid_leaves_a_readable_file(tmp_path, end):
    with subprocess.Popen(
        [sys.executable, "-c", RUN, str(tmp_path / "r")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        for _ in range(15):
            process.stdout.readline()
        process.send_signal(end)
        process.communicate()
    _, grids = read_by_vtk(tmp_path / "r" / "trajectory.vtkhdf")
    assert len(grids) >= 12
    assert all(np.isfinite(grid["von_mises"]).all() for grid in grids)
    assert grids[-1].n_cells == 16


def test_run_of_a_solid_resumes_with_its_fields(tmp_path):
    def study(until):
        mesh = vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1))
        rubber = vv.NeoHooke(young=1e3, poisson=0.3)
        solid = vv.Solid(mesh=mesh, material=rubber, density=1.0, angular_velocity=(1, 2, 3), name="block")
        return vv.Study(vv.System([solid]), until=until, step=0.02)

    run(study(0.4), tmp_path / "whole", progress=False, pictures=False)
    run(study(0.2), tmp_path / "split", progress=False, pictures=False)
    run(study(0.4), tmp_path / "split", progress=False, pictures=False, resume=True)
    whole, split = (read_by_vtk(tmp_path / name / "trajectory.vtkhdf")[1] for name in ("whole", "split"))
    assert len(whole) == len(split)
    np.testing.assert_array_equal(whole[-1]["cauchy"], split[-1]["cauchy"])


def test_smoothed_von_mises_has_the_kink_of_bending():
    """Pure bending u = k (x y, -x^2 / 2): the stress is E k y, von Mises' E k |y|, also on the neutral axis."""
    mesh = vv.BoxMesh(size=(2, 1, 1), counts=(4, 1, 1), cell="hex20", origin=(0, -0.5, 0))
    steel = vv.LinearElastic(young=200.0, poisson=0.0)
    beam = vv.Solid(mesh=mesh, material=steel)
    system = vv.System([beam])
    x, y, _ = beam.points.T
    bent = system.x.copy()
    bent[beam.motion.start :][: beam.motion.size] += (
        0.01 * np.column_stack([x * y, -(x**2) / 2, 0 * x]).ravel()
    )
    np.testing.assert_allclose(beam.nodal("von_mises", bent), 200 * 0.01 * np.abs(y), atol=1e-12)
    np.testing.assert_allclose(beam.nodal("principal_stresses", bent)[:, 0], np.maximum(2 * y, 0), atol=1e-12)


def test_single_components_are_fields(tmp_path):
    """A bar under tension along x: its stress alone, with name and unit; of a body that has none nothing is told."""
    bar = vv.Solid(
        name="bar",
        mesh=vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1)),
        material=vv.LinearElastic(young=1e6, poisson=0.0),
    )
    ball = vv.RigidBody(name="ball", shape=vv.Sphere(0.2), density=1.0, position=(5, 0, 0))
    pull = vv.Traction(solid=bar, faces="x1", traction=(7.0, 0, 0))
    rest = vv.Rigid(a=vv.Ground(), b=ball, at=(5, 0, 0))
    result = vv.quasi_static(
        vv.System([bar, ball, pull, vv.Fixed(solid=bar, nodes="x0"), rest], units="SI"), until=1.0, step=1.0
    )
    result.write(tmp_path / "t.vtkhdf", fields=("cauchy_xx", "cauchy"))
    with Trajectory(tmp_path / "t.vtkhdf") as motion:
        names = [surface.name for surface in motion.surfaces]
        single = motion.field("cauchy_xx", 1)
        np.testing.assert_allclose(single[names.index("bar")], 7.0, rtol=1e-9)
        assert np.isnan(single[names.index("ball")]).all()
        assert motion.labels.field("cauchy_xx") == "Cauchy stress xx [Pa]"
    with pytest.raises(vv.InputError, match="no field 'cauchy_xw'; did you mean"):
        result.write(tmp_path / "u.vtkhdf", fields=("cauchy_xw",))
