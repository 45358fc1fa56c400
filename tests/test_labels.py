"""Units and names as labels: in tables, files, plots and pictures, and never as factors."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

import visviva as vv
from visviva.base.unit_labels import Units
from visviva.measure.names import columns_of, units_of
from visviva.output import RunDirectory, Trajectory, read_table
from visviva.output.labels import Labels
from visviva.results.naming import clock_of
from visviva.scene import read_scene
from visviva.scene.writing import write_scene
from visviva.study.run import run


def test_names_follow_from_force_length_and_mass() -> None:
    """Against what 1 N/mm^2, 1 t mm^2/s^2 and so on are called."""
    units = Units.of("N-mm-t")
    told = {
        q: units[q] for q in ("time", "stress", "energy", "power", "velocity", "moment", "density", "angle")
    }
    assert told == {
        "time": "s", "stress": "MPa", "energy": "mJ", "power": "mW", "velocity": "mm/s", "moment": "N mm",
        "density": "t/mm³", "angle": "rad",
    }  # fmt: skip
    assert [Units.of("kN-mm-kg")[q] for q in ("time", "stress", "energy")] == ["ms", "GPa", "J"]
    assert [Units.of("SI")[q] for q in ("stress", "energy", "heat_flux", "energy_density")] == [
        "Pa", "J", "W/m²", "J/m³",
    ]  # fmt: skip
    assert Units.of({"length": "in", "time": "s"})["velocity"] == "in/s"
    assert Units.of({"length": "in"})["velocity"] == ""


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("N-mm-kg", "asks for a time of 0.0316 s"),
        ("N-mm-t-ms", "do not fit"),
        ("N-mm", "force-length-mass"),
        ("N-furlong-t", "'furlong' is no length"),
        (3, "names by quantity, not 3"),
    ],
)
def test_what_does_not_fit_is_refused(given: object, told: str) -> None:
    with pytest.raises(vv.InputError, match=told):
        vv.System([vv.PointMass(mass=1.0)], units=given)


def study(units: object, scheme: vv.Scheme | None = None) -> vv.Study:
    steel = vv.LinearElastic(young=200e3, poisson=0.3)
    bar = vv.Solid(
        mesh=vv.BoxMesh(size=(4, 1, 1), counts=(2, 1, 1)), material=steel, density=8e-9, name="bar"
    )
    pull = vv.Traction(solid=bar, faces="x1", traction=(1.0, 0, 0))
    system = vv.System([bar, pull, vv.Fixed(solid=bar, nodes="x0")])
    probes = {
        "tip": vv.Displacement(of=bar, at=(4, 0.5, 0.5)),
        "stress": vv.FieldAt(solid=bar, field="cauchy", at=(2, 0.5, 0.5)),
        "count": lambda s: 1.0,
    }
    return vv.Study(
        system, 2e-5, 1e-5, scheme or vv.EnergyMomentum(), probes, units=units, fields=("cauchy", "von_mises")
    )


def test_files_say_units_and_hold_the_same_numbers(tmp_path: Path) -> None:
    results = {}
    for name, units in (
        ("with", {"force": "N", "length": "mm", "time": "s", "count": "pieces"}),
        ("without", None),
    ):
        results[name] = run(study(units), tmp_path / name, pictures=False)
    header = (tmp_path / "with" / "probes.csv").read_text().splitlines()[0].split(",")
    assert header[:5] == ["time [s]", "tip_x [mm]", "tip_y [mm]", "tip_z [mm]", "stress_xx [MPa]"]
    assert header[-1] == "count [pieces]"
    assert (tmp_path / "with" / "ledger.csv").read_text().startswith("time [s],kinetic [mJ],")
    assert (tmp_path / "without" / "probes.csv").read_text().startswith("time,tip_x,tip_y,tip_z,stress_xx,")
    a, b = (read_table(tmp_path / name / "probes.csv") for name in results)
    assert list(a) == list(b)
    assert all((a[name] == b[name]).all() for name in a)
    labels = RunDirectory.open(tmp_path / "with").read_labels()
    assert labels.column("stress_zx") == "stress_zx [MPa]"
    with Trajectory(tmp_path / "with" / "trajectory.vtkhdf") as motion:
        assert motion.labels.field("von_mises") == "von Mises stress [MPa]"
        assert motion.moment(2e-5) == "t = 0.0000200 s"
    with h5py.File(tmp_path / "with" / "trajectory.vtkhdf") as file:
        assert file["VTKHDF/PointData/von_mises"].attrs["units"] == "MPa"
        assert file["VTKHDF/PointData/displacement"].attrs["units"] == "mm"
        assert file["VTKHDF/Points"].attrs["units"] == "mm"


def test_a_run_goes_on_with_other_labels(tmp_path: Path) -> None:
    first = study("N-mm-t")
    run(first, tmp_path / "r", pictures=False)
    again = study(None)
    again.until = 4e-5
    run(again, tmp_path / "r", pictures=False, resume=True)
    assert len(read_table(tmp_path / "r" / "probes.csv")["time"]) == 5
    assert json.loads((tmp_path / "r" / "labels.json").read_text())["units"] == {}


def test_load_steps_are_no_seconds(tmp_path: Path) -> None:
    run(study("N-mm-t", vv.Static()), tmp_path / "s", pictures=False)
    assert (tmp_path / "s" / "probes.csv").read_text().startswith("load_parameter,tip_x [mm],")
    assert (tmp_path / "s" / "ledger.csv").read_text().startswith("load_parameter,kinetic [mJ],")
    labels = RunDirectory.open(tmp_path / "s").read_labels()
    assert (labels.axis("time"), labels.moment(0.5, 1.0)) == ("load parameter", "load parameter 0.50")
    assert (clock_of(vv.ArcLength()), clock_of(vv.Midpoint())) == ("state", "time")
    path = Labels(clock="state", units={"time": "s"})
    assert (path.abscissa, path.moment(3.0, 1.0)) == ("load parameter", "state 3")


def test_scenes_have_units(tmp_path: Path) -> None:
    ball = vv.PointMass(mass=1.0, name="ball")
    probes = {"place": vv.Position(of=ball)}
    write_scene(
        vv.Study(vv.System([ball], units={"place": "furlong", "time": "s"}), 1.0, 0.1, probes=probes),
        tmp_path / "a.yaml",
    )
    assert read_scene(tmp_path / "a.yaml").system.units.names == {"place": "furlong", "time": "s"}
    text = (tmp_path / "a.yaml").read_text()
    (tmp_path / "b.yaml").write_text(text.replace("place: furlong", "plaice: furlong"))
    with pytest.raises(vv.InputError, match=r"b.yaml:\d+: units: .*'plaice'; did you mean 'place'"):
        read_scene(tmp_path / "b.yaml")


def test_components_are_named() -> None:
    assert columns_of("load", None, np.zeros(3)) == ["load_x", "load_y", "load_z"]
    beam = vv.Beam(
        mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=2),
        section=vv.TubeSection(radius=0.1, young=1.0, poisson=0.3, density=1.0),
    )
    inside = vv.Resultants(beam=beam, at=0.5)
    vv.System([beam])
    assert columns_of("s", inside, np.zeros(6))[2:4] == ["s_normal", "s_bending_1"]
    assert units_of("s", inside, np.zeros(6), Units.of("SI"))[2:4] == ["N", "N m"]
