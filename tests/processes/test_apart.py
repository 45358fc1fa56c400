"""What one process does apart from the others: refused with a sentence, or harmless; nobody waits for ever."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from processes.launch import launched, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
MESHES = """
import os
import sys
from pathlib import Path

import visviva as vv
from visviva.base.world import world

folder, rank = Path(sys.argv[1]), world().rank
mesh = vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2)).build()
mesh.write(folder / f"part{rank}.vtu")  # each its own
mesh.write(folder / f"part{rank}.inp")
if rank == 0:
    mesh.write(folder / "first.vtu")  # one alone
for _ in range(10):
    mesh.write(folder / "all.vtu")  # all at once
    assert len(vv.MeshFile(folder / "all.vtu").build().points) == 45
world().together("written")
try:
    mesh.write(folder / "no such folder" / "all.vtu")
except vv.InputError as error:
    told = world().together(f"{error}".partition(": ")[2])
if rank == 0:
    print(*sorted(os.listdir(folder)), len(set(told)))
"""


def test_meshes_are_written_by_whoever_calls_and_never_broken(tmp_path: Path) -> None:
    """What the second process wrote under a name of its own was never there, and one that wrote alone was refused."""
    (tmp_path / "meshes.py").write_text(MESHES)
    (tmp_path / "written").mkdir()
    done = launched(2, str(tmp_path / "meshes.py"), str(tmp_path / "written"))
    assert done.returncode == 0, done.stderr
    assert done.stdout == "all.vtu first.vtu part0.inp part0.vtu part1.inp part1.vtu 1\n"


APART = """
import sys

import visviva as vv
from visviva.base.world import world

kind, rank = sys.argv[1], world().rank
box = vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2))


def motion(t, X):
    if sys.argv[1] == "within" and world().rank == 1 and 0.1 < t < 0.2:
        raise RuntimeError("only here")
    return 0 * X


def system():
    block = vv.Solid(mesh=box, material=vv.NeoHooke(young=1.0, poisson=0.3), density=1.0, name="block")
    moved = vv.Prescribed(solid=block, nodes="x0", motion=motion)
    return vv.System([block, moved, vv.Gravity()])


def look(system):
    if kind == "observer" and rank == 1 and system.time > 0.09:
        raise LookupError("seen here alone")
    if kind == "observed edit" and system.time > 0.09:
        system.v[-1] *= 1 + 0.1 * rank


def again(*given, **more):
    try:
        given[0](*given[1:], **more)
    except (LookupError, RuntimeError):
        given[0](*given[1:], **more)


one, other = system(), system()
go = {"step": 0.05, "observe": look}
if kind == "observer":
    try:
        vv.simulate(one, until=0.2, **go)
    except LookupError:
        pass
    vv.simulate(other, until=0.2, **go)
if kind == "within":
    for _ in range(4):
        again(one.step, 0.05)

def fail(*given):
    raise (KeyboardInterrupt if kind == "interrupted" else RuntimeError)("only here")


if kind == "core":
    from visviva_petsc.world import Owners

    one.step(0.05)
    largest, Owners.largest = Owners.largest, fail if rank else Owners.largest
    try:
        one.step(0.05)
    except Exception:
        Owners.largest = largest
    one.step(0.05)
if kind in ("solver", "interrupted"):
    from visviva_petsc.solver import Solver

    one.step(0.05)
    solve, Solver.solve = Solver.solve, fail if rank else Solver.solve
    try:
        one.step(0.05)
    except BaseException:
        Solver.solve = solve
    one.step(0.05)
if kind == "one composes" and rank == 0:
    system()
if kind == "one begins anew":
    one.step(0.05)
    if rank == 1:
        one.reset()
if kind == "lengths":
    one.step(0.05 + 0.01 * rank)
if kind == "systems":
    (one if rank else other).step(0.05)
if kind == "ends":
    if rank == 0:
        one.step(0.05)
    sys.exit()
result = vv.simulate(one, until=one.time + 0.2, **go)
if kind == "one writes" and rank == 0:
    result.ledger.to_csv("alone.csv")
if kind == "other files":
    result.to_csv(f"part{rank}.csv", end=one.components[0].point((1, 1, 1)).position)
if kind == "other directories":
    result.write(f"part{rank}")
if kind == "one draws" and rank == 1:
    result.picture("alone.png")
one.v[-1] *= 1 + 0.1 * rank * (kind == "edit")
if kind == "edit, then a step":
    one.v[-1] *= 1 + 0.1 * rank
    one.step(0.05)
vv.simulate(one, until=0.5, **go)
if kind == "healthy":
    one.v[-1] *= 1.1
    for _ in range(3):
        one.step(0.05)
    if len(set(world().together(one.x.tobytes()))) == 1 and rank == 0:
        print("through")
"""
PARTED = {
    "observer": r"process 0 is to take a step of system 0 .*, process 1 to march system 1 \(after LookupError: seen h",
    "within": r"process 0 is to compare values \(Prescribed 'p.*, process 1 to take a step .* \(after \w+: .*only here",
    "core": r"process 1 of 2 is to take a step .* \(after RuntimeError: only here\), and process 0 waits for it",
    "solver": r"process 1 of 2 could not solve with the others: RuntimeError: only here\n",
    "interrupted": r"process 1 of 2 could not solve with the others: KeyboardInterrupt: only here\n",
    "one composes": r"process 0 is to compose a system, process 1 to march system 0\. Each runs the whole script",
    "one begins anew": r"process 0 is to march system 0, process 1 to compose a system\. Each",
    "lengths": r"process 0 is to take a step of system 0 from t = 0\.0 with h = 0\.05 by .* with h = 0\.06\d* by ",
    "systems": r"process 0 is to take a step of system 1 from t = 0\.0 .*, process 1 to take a step of system 0 ",
    "ends": r"process 1 of 2 has come to its end, and process 0 waits for it, to take a step of system 0 from t = 0\.0",
    "one writes": r"process 0 is to write alone\.csv, process 1 to march system 0\. Each runs the whole script",
    "other files": r"process 0 is to write part0\.csv, process 1 to write part1\.csv\. Each",
    "other directories": r"process 0 is to write part0, process 1 to write part1\. Each",
    "one draws": r"process 0 is to march system 0, process 1 to draw alone\.png\. Each",
    "edit": r"Solid 'block': rates of position \(unknowns from 0 on\) is ",
    "edit, then a step": r"process 1 to take a step of system 0 from t = 0\.2.* whose state is none of a step: array",
    "observed edit": r"process 1 to take a step of system 0 from t = 0\.1.* whose state is none of a step: array",
}
"""How scripts go apart, and what is told."""


@pytest.mark.parametrize("kind", PARTED)
def test_processes_that_go_apart_are_told(kind: str, tmp_path: Path) -> None:
    """They waited for each other for ever, or computed on, each with a state of its own."""
    (tmp_path / "apart.py").write_text(APART)
    done = launched(2, str(tmp_path / "apart.py"), kind, limit=60)
    assert done.returncode != 0
    assert len(re.findall(PARTED[kind], done.stderr)) == 1, done.stderr


def test_processes_that_do_the_same_go_on(tmp_path: Path) -> None:
    (tmp_path / "apart.py").write_text(APART)
    done = launched(2, str(tmp_path / "apart.py"), "healthy")
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["through"]


STARVED = """
import time

import numpy as np
from visviva.base.world import world
from visviva_petsc.world import World


class Late:
    def __init__(self, arrived):
        self.arrived, self.asked = arrived, 0

    def Test(self):
        self.asked += 1
        if self.asked == 1:
            time.sleep(1.5)  # as if there were no processor for it
        return self.asked > 4 and self.arrived.Test()


those = world()
wait = World.wait
if those.rank == 1:
    World.wait = lambda self, arrived, what: wait(self, Late(arrived), what)
numbers = np.ones(3)
those.sum(numbers)
if those.rank == 0:
    print(*numbers)
"""


def test_a_process_that_was_starved_is_waited_for(tmp_path: Path) -> None:
    """It looked twice at once, saw that others had gone on with what it had not heard of yet, and ended all."""
    (tmp_path / "starved.py").write_text(STARVED)
    done = launched(2, str(tmp_path / "starved.py"), limit=60)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["2.0", "2.0", "2.0"]


ROOM = """
import visviva as vv
from visviva import _core
from visviva.base.world import world
from visviva_petsc import gathered
from visviva_petsc.solver import Solver

fails = []


class Linear:
    def __init__(self, *given, **more):
        self.linear = _core.Linear(*given, **more)

    def __getattr__(self, name):
        return getattr(self.linear, name)

    def solve(self, *given):
        if fails:
            raise fails.pop()
        return self.linear.solve(*given)


def solve(self, *given):
    done = solve_all(self, *given)
    if fails and world().rank:
        raise fails.pop()
    return done


gathered._core = type("Core", (), {"Linear": Linear})
solve_all, Solver.solve = Solver.solve, solve
mesh = vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2))
block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1.0, poisson=0.3), density=1.0)
ball = vv.PointMass(mass=1.0, position=(3, 0, 0))
for body in (ball, block):
    system = vv.System([body, vv.Gravity()])
    system.step(0.05)
    fails = [MemoryError("no room for factors")]
    try:
        system.step(0.05)
    except Exception as error:
        told = world().together(f"{type(error).__name__}: {error}")
    fails.clear()
    system.step(0.05)
    reached = world().together(system.x.tobytes())
    if world().rank == 0:
        print(system.linear_explanation.startswith("2 processes, PETSc"), *told, len(set(reached)), sep="; ")
"""


def test_what_one_process_cannot_solve_all_fail_by_and_go_on(tmp_path: Path) -> None:
    """The others waited within the solver for ever."""
    (tmp_path / "room.py").write_text(ROOM)
    done = launched(2, str(tmp_path / "room.py"), limit=60)
    assert done.returncode == 0, done.stderr
    words = "MemoryError: no room for factors"
    alone = f"RunError: process 1 of 2 could not solve with the others: {words}"
    assert done.stdout.splitlines() == [f"True; {words}; {words}; 1", f"True; {alone}; {alone}; 1"]


REASONS = """
import sys

import numpy as np
import visviva as vv
from visviva.base.world import world


tried = []  # materials are tried beforehand, wherever that is


def energy(C):
    if tried and np.abs(C[0] - 1).max() > 0.1:
        raise ValueError("stretched too far")
    return 20 * ((C[0] + C[1] + C[2] - 3) ** 2 + 2 * (C[3] ** 2 + C[4] ** 2 + C[5] ** 2))


def pulled(t, X):
    return np.outer(np.full(len(X), 0.2 * t if sys.argv[1] == "raises" else -3 * t), [1, 0, 0])


material = vv.UserMaterial(function=energy) if sys.argv[1] == "raises" else vv.NeoHooke(young=100.0, poisson=0.3)
bar = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(8, 1, 1)), material=material, name="bar")
held = vv.Fixed(solid=bar, nodes=np.flatnonzero(bar.points[:, 0] < 3.4))
system = vv.System([bar, held, vv.Prescribed(solid=bar, nodes="x1", motion=pulled)])
tried.append("all")
try:
    vv.simulate(system, until=1.0, step=1.0, scheme=vv.Static(halvings=2))
except vv.RunError as error:
    if world().rank == 0:
        print(error)
"""


@pytest.mark.parametrize(
    ("kind", "words"),
    [("inverts", "element 6 of Solid 'bar' near (3.062, "), ("raises", "stretched too far")],
)
def test_why_another_process_has_failed_is_told(kind: str, words: str, tmp_path: Path) -> None:
    """The first one said that another refuses, or has found no value, and nothing of what or where."""
    (tmp_path / "reasons.py").write_text(REASONS)
    one, two = (launched(n, str(tmp_path / "reasons.py"), kind) for n in (0, 2))
    assert words in one.stdout
    assert words in two.stdout, two.stderr
    assert kind == "raises" or two.stdout == one.stdout


CAUGHT = """
import sys

import numpy as np
import visviva as vv
from visviva.base.world import world


class Own(vv.InputError):
    pass


kinds = {"key": KeyError, "run": vv.RunError, "input": vv.InputError, "memory": MemoryError, "exit": SystemExit,
         "value": ValueError, "stop": StopIteration, "own": Own, "empty": RuntimeError, "bare": Own}


def run(kind):
    def traction(t, X):
        if kind and t > 0.06 and X[:, 0].max() > 3:  # cells of one process
            raise kinds[kind](*["late\\nand in two lines"] * (kind not in ("empty", "bare")))
        return np.zeros_like(X)

    block = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(8, 2, 2)), density=1.0, angular_velocity=(0, 0, 1),
                     material=vv.NeoHooke(young=100.0, poisson=0.3), name="block")
    system = vv.System([block, vv.Traction(solid=block, faces="x1", traction=traction)])
    vv.simulate(system, until=0.1, step=0.05)
    return "went on"


for kind in (*kinds, ""):
    try:
        told = run(kind)
    except (Exception, SystemExit) as error:
        told = f"{kind}: {type(error).__name__}: {error!s}".replace("\\n", " ")
    those = world().together(told)
    if world().rank == 0:
        print(*dict.fromkeys(those), sep="; ")
"""


def test_what_a_function_raises_in_one_process_all_may_catch(tmp_path: Path) -> None:
    """For the others the step had failed: they halved it, and waited for one that had caught the error and went on."""
    (tmp_path / "caught.py").write_text(CAUGHT)
    one, two = (launched(n, str(tmp_path / "caught.py"), limit=120) for n in (0, 2))
    assert one.returncode == two.returncode == 0, two.stderr
    assert one.stdout.splitlines()[-1] == "went on"
    assert "key: RunError: Traction: its traction raised KeyError" in one.stdout
    assert "stop: RunError: Traction: its traction raised StopIteration" in one.stdout
    assert "own: Own: late" in one.stdout
    assert "bare: Own: \n" in one.stdout
    assert "traction raised RuntimeError\n" in one.stdout
    assert two.stdout == one.stdout


RAISED = """
import visviva as vv
from visviva_petsc.world import first_failed, raised_elsewhere

turned, key = ("", "turned inside out", 3), ("KeyError", "'late'", -1)
print(first_failed([turned, key]) == key, first_failed([("", "", -1), turned]) == turned)


class Two(vv.RunError):
    def __init__(self, one, other):
        super().__init__(f"{one} {other}")


for name in ("KeyError", "UnicodeDecodeError", "StepFailure", "Two", "Unknown"):
    print(type(raised_elsewhere(name, "told")).__name__)
"""


def test_what_a_function_raises_goes_before_failed_steps(tmp_path: Path) -> None:
    """Who had failed otherwise tried a shorter step, without the one that had raised; some classes take more words."""
    (tmp_path / "raised.py").write_text(RAISED)
    done = launched(0, str(tmp_path / "raised.py"))
    assert done.stdout.split() == ["True", "True", "KeyError", "UnicodeError", *3 * ["RunError"]], done.stderr


COUNTS = """
import sys

import visviva as vv
from visviva.base.world import world

calls, rank = [0], world().rank


def force(t, x, v):
    calls[0] += 1
    return (1.0, 0, 0)


def other(t, x, v):
    return (1.0 + 0.0 * rank, 0, 0)


def given(t, x, v, scale=1.0, number=rank):
    return (scale, 0, 0)


for _ in range(2):
    ball = vv.PointMass(mass=1.0, name="ball")
    vv.simulate(vv.System([ball, vv.Force(on=ball, force=force, name="push")]), until=0.1, step=0.05)
counted = world().together(calls[0])
for differs in (other, given):
    try:
        vv.System([ball, vv.Force(on=ball, force=differs, name="push")])
    except vv.InputError as error:
        if rank == 0:
            print(counted[0] > counted[1], error)
"""


def test_functions_may_count_and_what_differs_is_named(tmp_path: Path) -> None:
    """The second system was refused, by digests of a function that processes do not call as often."""
    (tmp_path / "counts.py").write_text(COUNTS)
    done = launched(2, str(tmp_path / "counts.py"))
    assert done.returncode == 0, done.stderr
    for name, told in zip(
        ("rank in function other", "number in function given"), done.stdout.splitlines(), strict=True
    ):
        named = f"Force 'push': force: {name} is 0 in process 0, 1 in process 1. Each"
        assert told.startswith(f"True processes differ: {named}"), told


THREADS = """
import sys
from concurrent.futures import ThreadPoolExecutor

import visviva as vv

if sys.argv[1] == "joined":
    vv.System([vv.PointMass(mass=1.0)])


def moved(k):
    system = vv.System([vv.PointMass(mass=1.0, velocity=(k, 0, 0))])
    system.step(0.1)
    return float(system.x[0])


with ThreadPoolExecutor(2) as threads:
    try:
        print(*(round(x, 9) for x in threads.map(moved, (1, 2))))
    except vv.InputError as error:
        print(error)
"""


@pytest.mark.parametrize("kind", ["first", "joined"])
def test_threads_do_nothing_with_other_processes(kind: str, tmp_path: Path) -> None:
    """Whose order is another one in each: they waited for each other for ever, or MPI ended them by internal errors."""
    (tmp_path / "threads.py").write_text(THREADS)
    one, two = (launched(n, str(tmp_path / "threads.py"), kind, limit=60) for n in (0, 2))
    assert one.stdout.split() == ["0.1", "0.2"]
    assert two.returncode == 0, two.stderr
    assert two.stdout.count("a thread of its own cannot ") == 2


EARLY = """
import os

from visviva_petsc import world

if os.environ["PMI_RANK"] == "1":
    def interrupted(*given):
        raise KeyboardInterrupt

    world.World.__init__ = interrupted
from visviva.base.world import world as together

together()
print("through")
"""


def test_an_interrupt_before_all_have_come_together_ends_all(tmp_path: Path) -> None:
    """One waited for others to finalize MPI, and these for it to come."""
    (tmp_path / "early.py").write_text(EARLY)
    done = launched(2, str(tmp_path / "early.py"), limit=60)
    assert done.returncode != 0
    assert "through" not in done.stdout


FAILING = """
import os
import sys

import visviva as vv

vv.System([vv.PointMass(mass=1.0)])
is_second = os.environ["PMI_RANK"] == "1"
if sys.argv[1] == "same":
    raise ValueError(f"neither {0.1 + 1e-17 * is_second} nor {is_second:d}")
raise KeyError("lamp") if is_second else ValueError("rope")
"""


@pytest.mark.parametrize(("kind", "told"), [("same", ["ValueError"]), ("each", ["ValueError", "KeyError"])])
def test_all_that_fail_tell_of_it_if_they_differ(kind: str, told: list[str], tmp_path: Path) -> None:
    """What the first failed by was all that was told."""
    (tmp_path / "failing.py").write_text(FAILING)
    done = launched(2, str(tmp_path / "failing.py"), kind, limit=60)
    assert done.returncode == 1
    assert re.findall(r"^(\w+Error)", done.stderr, re.MULTILINE) == told
    assert done.stderr.count("process 1 of 2") == len(told) - 1
