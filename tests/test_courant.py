"""The CFL number of a flow: probe, audit, summary."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import visviva as vv
from visviva.study.run import run


def stream(cell: str, speed: float = 2.0) -> tuple[vv.System, vv.Fluid]:
    """Along x through cells of the size 1/4."""
    flat = cell.startswith(("tri", "quad"))
    shape: Any = vv.RectangleMesh if flat else vv.BoxMesh
    d = 2 if flat else 3
    mesh = shape(size=(1.0,) * d, counts=(4,) * d, cell=cell)
    sides: Any = tuple((f"{c}0", f"{c}1") for c in "xyz"[:d])
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0, velocity=(speed, 0, 0), periodic=sides)
    return vv.System([fluid]), fluid


@pytest.mark.parametrize("cell", ["quad4", "quad9", "tri3", "tri6", "hex8"])
def test_cells_passed_in_a_step(cell: str) -> None:
    system, fluid = stream(cell)
    probe = vv.Courant(fluid=fluid)
    assert probe(system) == 0.0
    vv.simulate(system, until=0.1, step=0.05)
    assert probe(system) == pytest.approx(2.0 * 0.05 / 0.25, rel=1e-9)
    assert system.gauges() == {"CFL": probe(system)}


def test_audit_and_summary_show_it(tmp_path: Path) -> None:
    system, _ = stream("quad4")
    result = run(vv.Study(system, 0.1, 0.05), tmp_path / "run", progress=False, pictures=False)
    assert ", CFL 0.4\n" in result.audit()
    assert json.loads((tmp_path / "run" / "summary.json").read_text())["last_step"]["CFL"] == pytest.approx(
        0.4
    )


def test_steady_flow_has_none() -> None:
    fluid = vv.Fluid(mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)), density=1.0, viscosity=1.0)
    system = vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), vv.Gravity(acceleration=(0, -9.81, 0))])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert system.gauges() == {}
