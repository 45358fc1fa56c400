"""The phases of a run: they add up, and what a run is made of is found in the phase of its name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import visviva as vv
from visviva.output import RunDirectory
from visviva.study.profile import PHASES
from visviva.study.run import run


def profile(parts: list[Any], path: Path, scheme: vv.Scheme, newton: vv.Newton, **how: Any) -> dict[str, Any]:
    """Figures of a run of 2 steps."""
    study = vv.Study(vv.System(parts, newton), until=2.0, step=1.0, scheme=scheme)
    texts: list[str] = []
    run(study, path, pictures=False, profile=True, tell=texts.append, every=1, **how)
    found: dict[str, Any] = RunDirectory.open(path).read_summary()["profile"]
    assert len(texts) == 1
    assert all(name in texts[0] for name in PHASES)
    return found


def block(n: int) -> list[Any]:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n))
    solid = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3), density=1.0)
    pull = vv.Traction(solid=solid, faces="x1", traction=(0, 0, -20.0), times="t/2")
    return [solid, vv.Fixed(solid=solid, nodes="x0"), pull]


def test_factors_of_a_cube_take_longer_than_anything_else(tmp_path: Path) -> None:
    """They cost the square of the equations, the rest of Newton's method their number."""
    found = profile(block(9), tmp_path, vv.Static(), vv.Newton(linear=vv.Direct(library="eigen")))
    assert found["factorisation"] > max(found[name] for name in PHASES if name != "factorisation")
    assert found["contact"] == 0.0
    assert found["iterations"] == 0
    assert found["rest"] > 0
    assert min(found[name] for name in ("assembly", "solution", "ledger", "output")) > 0


def test_iterations_are_counted(tmp_path: Path) -> None:
    """Without a preconditioner a cube of a few cells takes tens of them."""
    options = vv.Newton(linear=vv.Iterative(method="cg", preconditioner="none"))
    found = profile(block(4), tmp_path, vv.Static(), options)
    assert found["iterations"] > 20 * found["solutions"] > 0


def test_contact_is_a_phase_of_its_own(tmp_path: Path) -> None:
    parts = block(3)
    floor = vv.Plane(at=(0, 0, -0.001), normal=(0, 0, 1))
    parts += [floor, vv.Contact(first=parts[0], first_faces="z0", second=floor)]
    found = profile(parts, tmp_path, vv.Static(), vv.Newton())
    assert found["contact"] > 0


def test_a_run_that_fails_tells_where_its_time_went(tmp_path: Path) -> None:
    ball = vv.PointMass(mass=1.0, name="ball")
    push = vv.Force(on=ball, force=lambda t, *_: (1.0 / max(1 - t, 0.0), 0.0, 0.0))
    study, texts = vv.Study(vv.System([ball, push]), until=2.0, step=0.5), list[str]()
    with pytest.raises(vv.VisvivaError):
        run(study, tmp_path, pictures=False, profile=True, tell=texts.append)
    assert "linear systems solved" in texts[0]
