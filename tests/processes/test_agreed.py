"""What functions of the user give in every process has to be the same: refused by name, where it is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from processes.launch import launched, missing
from visviva.output.tables import read_table

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
UNLIKE = """
import sys
from pathlib import Path

import numpy as np
import visviva as vv
from visviva.base.world import world

place, rank = Path(sys.argv[1]), world().rank
kept = {}


def noise(t):
    k = round(t / 0.05)
    if k not in kept:
        kept[k] = 0.01 * np.random.normal() if k else 0.0
    return kept[k]


class Drive:
    felt = 0.0

    def wind(self, t, x, v):
        self.felt = np.sin(20 * t)
        return (self.felt, 0, 0)

    def push(self, t):
        return 0.1 * self.felt

    def asked(self, t):
        return 0.1 * world().first(self.felt)

    def asking(self, t, x, v):
        return (world().largest(0.0) if t > 0.07 else 0.0, 0, 0)


class Rubber:
    peak = 0.0

    def __call__(self, C):
        self.peak = max(self.peak, float(np.max(C[0].real)))
        a, b, c, d, e, f = C
        grown = np.log(a * (b * c - e**2) - d * (d * c - e * f) + f * (d * e - b * f))
        return 19.0 * (a + b + c - 3 - grown) + 7.5 * grown**2


def bar(*parts, material=None, load=None, **given):
    material = material or vv.NeoHooke(young=100.0, poisson=0.3)
    solid = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(8, 1, 1)), material=material, density=1.0, name="bar")
    ends = [vv.Fixed(solid=solid, nodes="x0")]
    if load is not None:
        ends.append(vv.Traction(solid=solid, faces="x1", traction=(0, 0, 0.1), times=load, name="load"))
    if given:
        ends.append(vv.Prescribed(solid=solid, nodes="x1", name="end", **given))
    return vv.System([solid, *parts, *ends])


def moved(motion, *parts):
    system = bar(*parts, motion=(None, None, motion))
    vv.simulate(system, until=0.15, step=0.05)
    return float(system.x.sum())


def shaken():
    moved(noise)


def driven(motion="push"):
    drive, ball = Drive(), vv.PointMass(mass=1.0, position=(9, 0, 0), name="ball")
    return moved(getattr(drive, motion), ball, vv.Force(on=ball, force=drive.wind))


def pressed():
    vv.simulate(bar(load=noise), until=0.1, step=0.05)


def heated():
    store = vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 1, 1)), conductivity=1.0, name="store")
    wall = vv.PrescribedTemperature(body=store, nodes="x0", value=lambda t, X: noise(t) + 0 * X[:, 0], name="wall")
    vv.simulate(vv.System([store, wall]), until=0.1, step=0.05)


def stretched(of=float, kind="run"):
    rubber = Rubber()
    system = bar(material=vv.UserMaterial(function=rubber), motion=("9*t", None, None))
    probes = {"tip": lambda s: s.x[-3], "peak": lambda s: of(rubber.peak)}
    if kind == "run":
        name = f"{of.__name__} {world().size}"
        vv.run(vv.Study(system, 0.1, 0.05, title="bar", probes=probes), place / name, pictures=False, progress=False)
    else:
        vv.simulate(system, until=0.1, step=0.05, record=probes)
    return rubber.peak if rank == 0 else None


def recorded():
    stretched(kind="record")


def stopped():
    vv.arc_length(bar(load="t"), step=0.5, until=1.0, stop=lambda system: world().rank == 1)


def asked():
    return driven("asked")


def asking():
    ball = vv.PointMass(mass=1.0, position=(9, 0, 0), name="ball")
    return moved(0.0, ball, vv.Force(on=ball, force=Drive().asking, name="wind"))


def largest():
    stretched(world().largest)


def printed():
    def tip(system):
        if rank == 0:
            print("", end="")
        return system.x[-3]

    for until in (0.1, 0.2):
        study = vv.Study(bar(), until, 0.05, title="bar", probes={"tip": tip})
        vv.run(study, place / f"printed {world().size}", resume=until > 0.1, pictures=False, progress=False)


def rounded():
    return moved(lambda t: 0.1 * t * (1 + 2e-15 * world().rank))


def rounded_by_place():
    system = bar(motion=lambda t, X: 0.1 * np.sin(t) * (1 + 2e-15 * world().rank) + 0 * X)
    vv.simulate(system, until=0.15, step=0.05)
    return float(system.x.sum())


begun = (asked, largest, printed, rounded, rounded_by_place)
for case in (shaken, driven, pressed, heated, stretched, recorded, stopped, *begun, asking):
    kept.clear()
    try:
        told = f"went on to {case()}"
    except vv.InputError as error:
        told = str(error)
    if rank == 0:
        print(told, flush=True)
"""


def test_functions_that_give_processes_other_values_are_refused(tmp_path: Path) -> None:
    """States of processes parted, and tables held what the first one knew, without a word.

    What all are asked for is that of one process; who prints by its number may go on with a run.
    """
    (tmp_path / "unlike.py").write_text(UNLIKE)
    one, two = (launched(n, str(tmp_path / "unlike.py"), str(tmp_path), limit=200) for n in (0, 2))
    assert one.returncode == two.returncode == 0, one.stderr + two.stderr
    assert [line[:10] for line in one.stdout.splitlines()] == 13 * ["went on to"]
    beginnings = (
        "Prescribed 'end': what it prescribes at t = 0.05 is ",
        "Prescribed 'end': what it prescribes at t = 0.1 is 0.0479425538604203 in process 0, 0.0 in process 1. Every",
        "Traction 'load': its function of time at t = 0.05 is ",
        "PrescribedTemperature 'wall': what it prescribes at t = 0.05 is ",
        "probe 'peak': its value at t = 0.05 is ",
        "record 'peak': its value at t = 0.05 is ",
        "arc_length: stop: its answer at 0.5",
    )
    told = two.stdout.splitlines()
    for line, begins in zip(told, beginnings, strict=False):
        assert line.startswith(f"processes differ: {begins}"), line
        assert "give random numbers a seed" in line
    assert "is False in process 0, True in process 1." in told[6]
    assert [line[:10] for line in told[len(beginnings) : -1]] == 5 * ["went on to"]
    ends = [[float(line.split()[-1]) for line in lines[-3:-1]] for lines in (one.stdout.splitlines(), told)]
    np.testing.assert_allclose(ends[1], ends[0], rtol=1e-10)
    assert told[-1].startswith(
        "Force 'wind', its force: it cannot find the largest of their numbers: each process comes to that by itself"
    )
    for name, rows in (("largest", 3), ("printed", 5)):
        tables = [read_table(tmp_path / f"{name} {n}" / "probes.csv") for n in (1, 2)]
        for values, others in zip(*(table.values() for table in tables), strict=True):
            assert len(values) == rows
            np.testing.assert_allclose(others, values, rtol=1e-9, atol=1e-12)
