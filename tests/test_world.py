"""Processes that share a system, as far as one process can test it; `tests/petsc` has the rest."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spl

import visviva as vv
from visviva import _core
from visviva.base import world as seam
from visviva.base.told import digest_of
from visviva.linear.choice import Choice, Direct, LinearOptions, Problem
from visviva.system import agreement


class Factors:
    """A solver from outside: scipy's sparse LU, or one that gives up."""

    iterations, message = 0, ""

    def __init__(self, works: bool) -> None:
        self.works, self.name = works, "LU of scipy"

    def analyze(self, row: Any, col: Any, unknown: Any, of: dict[str, Any]) -> None:
        self.row, self.col, self.unknown = row.copy(), col.copy(), unknown.copy()
        self.shape = len(unknown), of["modes"].shape[1], len(of["multiplier"]), len(of["node"]) - 1

    def factor(self, values: Any) -> bool:
        n = len(self.unknown)
        self.lu = spl.splu(sp.csr_array((values, self.col, self.row), shape=(n, n)).tocsc())
        self.message = "" if self.works else "it does not want to"
        return self.works

    def solve(self, r: Any, d: Any, tolerance: float) -> bool:
        d[self.unknown] = self.lu.solve(-r[self.unknown])
        return True

    def forget(self) -> None:
        pass


class Outside(LinearOptions):
    """Such solvers, and the core's factors after them."""

    def __init__(self, works: bool) -> None:
        self.works, self.made = works, []

    def choose(self, problem: Problem) -> Choice:
        choice = _core.LinearChoice()
        choice.backend = _core.Backend.outside
        choice.set_outside(self.make)
        return Choice((choice, *Direct(library="eigen").choose(problem).in_order), "from outside")

    def make(self) -> Factors:
        self.made.append(Factors(self.works))
        return self.made[-1]


def pulled(linear: LinearOptions | None = None) -> vv.System:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(3, 2, 2))
    block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=10.0, poisson=0.3), density=1.0)
    parts = [block, vv.Fixed(solid=block, nodes="x0"), vv.Gravity()]
    return vv.System(parts, newton=vv.Newton(linear=linear))


def test_solvers_from_outside_give_what_those_of_the_core_give() -> None:
    options, own = Outside(works=True), pulled()
    system = pulled(options)
    for s in (system, own):
        vv.simulate(s, until=0.2, step=0.05)
    moved = np.abs(own.x - own.field(own.components[0], "position").values).max()
    assert np.abs(system.x - own.x).max() < 1e-12 * moved
    assert "scipy" in system.core.solver
    assert options.made[-1].shape == (3 * 27, 6, 3 * 36, 27)  # nodes that are held whole have no equations


def test_where_a_solver_from_outside_gives_up_the_next_one_takes_over() -> None:
    system = pulled(Outside(works=False))
    vv.simulate(system, until=0.1, step=0.05)
    assert "it does not want to" in system.core.linear_message
    assert "scipy" not in system.core.solver


def test_a_process_alone_adds_nothing() -> None:
    alone, values = seam.Alone(), np.arange(3.0)
    alone.sum(values)
    assert values.tolist() == [0, 1, 2]
    assert alone.together("all") == ["all"]
    assert alone.largest(2.0) == alone.first(2.0) == 2.0
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(3, 2, 2)).build()
    assert alone.parts(mesh).tolist() == 12 * [0]


def test_the_first_process_announces(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    other = seam.Alone()
    other.rank, other.size = 1, 2
    for those, said in ((seam.Alone(), "it is so\n"), (other, "")):
        monkeypatch.setattr(seam, "_joined", [those])
        seam.announce("it is so")
        assert capsys.readouterr().err == said


def test_a_package_of_another_release_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    package = SimpleNamespace(SEAM=seam.SEAM + 1, __version__="9.9", __spec__=SimpleNamespace())
    monkeypatch.setitem(sys.modules, seam.PACKAGE, package)
    monkeypatch.setenv("PMI_SIZE", "2")
    monkeypatch.setattr(seam, "_joined", [])
    with pytest.raises(vv.InputError, match=r"visviva_petsc 9\.9 goes with another version of visviva"):
        pulled()


def test_one_file_of_the_core_speaks_with_other_processes() -> None:
    """What is decided elsewhere by what one process knows lets others wait forever."""
    core = Path(__file__).parents[1] / "cpp" / "visviva"
    assert [file.name for file in sorted(core.rglob("*.?pp")) if "processes_->" in file.read_text()] == [
        "together.cpp"
    ]


class Beside(seam.Alone):
    """The first of two processes; the other tells what it is given to tell, or the same."""

    size = 2

    def __init__(self, other: Any = None) -> None:
        self.other = other

    def together(self, values: Any) -> list[Any]:
        told = digest_of(repr(self.other)) if isinstance(values, str) else self.other
        return [values, values if self.other is None else told]


def test_the_first_difference_between_processes_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    ball = vv.PointMass(mass=1.0, name="ball")
    fields = vv.System([ball]).model.fields
    monkeypatch.setattr(seam, "_joined", [Beside()])
    agreement.refuse_different([ball], vv.Newton())
    agreement.agree_on_states(fields, np.zeros(3), np.zeros(3))
    agreement.refuse_different_arguments("march", until=1.0)
    monkeypatch.setattr(seam, "_joined", [Beside({"march": {"until": "2", "step": "1"}})])
    with pytest.raises(vv.InputError, match=r"differ: march: until is 1 in process 0, 2 in process 1\. Each"):
        agreement.refuse_different_arguments("march", until=1.0, step=1.0)
    monkeypatch.setattr(seam, "_joined", [Beside({})])
    with pytest.raises(
        vv.InputError, match=r"differ: PointMass 'ball': what is held of position .* nothing in process 1"
    ):
        agreement.agree_on_states(fields, np.zeros(3), np.zeros(3))


class Rounded(seam.Alone):
    """The second of two processes, of which the first has a little more."""

    rank, size = 1, 2

    def __init__(self, more: float) -> None:
        self.more = more

    def first(self, value: Any) -> Any:
        return [v + self.more for v in value]

    def together(self, values: Any) -> list[Any]:
        return [values + self.more, values] if isinstance(values, np.ndarray) else [values]


def test_states_that_differ_by_rounding_are_those_of_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rates by differences of functions were compared to the bit: other processors could not begin at all."""
    ball = vv.PointMass(mass=1.0, position=(3, 0, 0), name="ball")
    fields = vv.System([ball]).model.fields
    x, v = np.array([3.0, 0, 0]), np.array([0, 1e-16, 0])
    monkeypatch.setattr(seam, "_joined", [Rounded(1e-14)])
    agreement.agree_on_states(fields, x, v)
    np.testing.assert_array_equal(x, np.array([3.0, 0, 0]) + 1e-14)
    np.testing.assert_array_equal(v, np.array([0, 1e-16, 0]) + 1e-14)
    monkeypatch.setattr(seam, "_joined", [Rounded(1e-7)])
    with pytest.raises(
        vv.InputError, match=r"PointMass 'ball': state of position .* is 3\.0000001\d* in process 0, 3\.0"
    ):
        agreement.agree_on_states(fields, x, v)


def test_what_chooses_its_steps_is_closed_where_their_march_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    system, closed = vv.System([vv.PointMass(mass=1.0)]), []

    def steps() -> Iterator[int]:
        try:
            yield from range(3)
        finally:
            closed.append(True)

    monkeypatch.setattr(seam, "_joined", [Beside()])
    own = steps()
    marched = agreement.in_step(system, own)
    assert next(marched) == 0
    marched.close()  # type: ignore[attr-defined]
    assert closed


def test_comparison_takes_no_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bytes are hashed at some hundred megabytes per second at least: no loop over nodes."""
    import time

    mesh = vv.Mesh(np.random.default_rng(0).normal(size=(1_000_000, 3)), {"tet4": [(0, 1, 2, 3)]})
    ball = vv.PointMass(mass=1.0)
    vars(ball)["name"] = mesh  # whatever argument
    monkeypatch.setattr(seam, "_joined", [Beside()])
    start = time.process_time()
    agreement.refuse_different([ball], vv.Newton())
    assert time.process_time() - start < 0.5  # 24 MB


class Second(seam.Alone):
    """The second of two processes, which gets what the first one sends."""

    rank, size = 1, 2

    def __init__(self, sent: Any) -> None:
        self.sent = sent

    def first(self, value: Any) -> Any:
        return self.sent


def test_what_the_first_process_gets_all_have(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    result = vv.simulate(vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0))]), until=0.2, step=0.1)
    monkeypatch.setattr(seam, "_joined", [Second(("written", None))])
    assert seam.by_first("write", lambda: "never done here") == "written"
    result.ledger.to_csv(tmp_path / "ledger.csv")
    assert not list(tmp_path.iterdir())
    monkeypatch.setattr(seam, "_joined", [Second((None, vv.RunError("the disk is full")))])
    with pytest.raises(vv.RunError, match="the disk is full"):
        result.plot(tmp_path / "plot.png")


def test_systems_that_were_refused_do_not_count() -> None:
    """One process that was refused one alone had other numbers for all later systems, none of which went on then."""
    before = vv.System([vv.PointMass(mass=1.0)]).composition.number
    with pytest.raises(vv.InputError, match="no unknowns"):
        vv.System([vv.Ground()])
    assert vv.System([vv.PointMass(mass=1.0)]).composition.number == before + 1
