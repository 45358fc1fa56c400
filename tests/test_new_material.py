"""The new material of docs/howto/new_physics.rst, put where it says, is one of the core's: built and asked."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import textwrap
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

import visviva as vv
from visviva.component.component import settings
from visviva.component.values import Number
from visviva.material.material import VOLUMETRIC, Material, Volumetric

Array = NDArray[np.float64]
ROOT = Path(__file__).parent.parent

ASK = """
#define VISVIVA_ISA asked
#define VISVIVA_WIDTH 1
#include "visviva/material/response.hpp"
#include <cstdio>
#include <cstdlib>
using namespace visviva;
using namespace visviva::asked;
int main(int, char** given) {
    constexpr MaterialTraits its = traits(MaterialKind::demiray);
    V c[6], p[material_max_parameters] = {};
    for (int k = 0; k < 6; ++k) c[k] = broadcast(std::atof(given[1 + k]));
    for (int k = 0; k < 4; ++k) p[k] = broadcast(std::atof(given[7 + k]));
    Response r;
    respond<true>(its.kind, c, p, r);
    std::printf("%s %d %.17g", its.name, its.bulk, r.W[0]);
    for (const V& s : r.s) std::printf(" %.17g", s[0]);
}
"""


def block(name: str) -> str:
    """A block of code of the how-to."""
    page = (ROOT / "docs" / "howto" / "new_physics.rst").read_text()
    found = re.search(rf"   :name: {name}\n\n((?:   .*\n|\n)+)", page)
    assert found, name
    return textwrap.dedent(found[1]).strip() + "\n"


@pytest.fixture(scope="module")
def asked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A program over a copy of the core's materials with the new one."""
    compiler = shutil.which(os.environ.get("CXX", "c++"))
    assert compiler, "a C++ compiler is needed, as for the core"
    place = tmp_path_factory.mktemp("core")
    for room in ("base", "material"):
        shutil.copytree(ROOT / "cpp" / "visviva" / room, place / "visviva" / room)
    kinds, energies = (
        place / "visviva" / "material" / name for name in ("material_list.hpp", "materials.hpp")
    )
    kinds.write_text(kinds.read_text() + block("list of materials"))
    mark = "/// Calls `use`"
    text = energies.read_text()
    assert text.count(mark) == 1
    energies.write_text(text.replace(mark, block("energy of the material") + "\n" + mark))
    (place / "ask.cpp").write_text(ASK)
    subprocess.run(
        [compiler, "-std=c++20", "-w", "-I", str(place), str(place / "ask.cpp"), "-o", str(place / "ask")],
        check=True,
    )
    return place / "ask"


def made() -> Material:
    """The material of the how-to's class."""

    class Kind:
        DEMIRAY = 99  # of the core built here it is none

    names = {
        "dataclass": dataclass, "settings": settings, "Material": Material, "Number": Number, "Volumetric": Volumetric,
        "VOLUMETRIC": VOLUMETRIC, "ClassVar": ClassVar, "Kind": Kind, "__name__": __name__,
    }  # fmt: skip
    exec(block("class of the material"), names)
    made: Material = names["Demiray"](shear=3.0, stiffening=0.7, bulk=11.0)  # type: ignore[operator]
    return made


def energy(c: Array) -> float:
    """mu / 2k (exp(k (I1 J^(-2/3) - 3)) - 1) + K (J^2 - 1 - 2 ln J) / 4 of C = I + c, with full tensors."""
    C = np.eye(3) + c[[[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    J = np.sqrt(np.linalg.det(C))
    W = 3.0 / 1.4 * np.expm1(0.7 * (np.trace(C) * J ** (-2 / 3) - 3))
    return float(W + 11.0 / 4 * (J**2 - 1 - 2 * np.log(J)))


def test_the_new_material_is_one_of_the_core(asked: Path) -> None:
    c = np.array([0.3, -0.1, 0.2, 0.15, -0.05, 0.1])
    given = [str(x) for x in (*c, *made().constants())]
    answer = subprocess.run([asked, *given], check=True, capture_output=True, text=True).stdout.split()
    assert answer[:2] == ["DEMIRAY", "2"]
    W, *s = map(float, answer[2:])
    assert energy(c) == pytest.approx(W, rel=1e-13)
    for k, d in enumerate(1e-5 * np.eye(6)):  # an entry off the diagonal stands for two
        slope = (energy(c + d) - energy(c - d)) / 2e-5
        assert slope == pytest.approx((1 if k < 3 else 2) * s[k], rel=1e-7)


def test_it_is_small_and_in_as_few_places_as_it_says() -> None:
    names = (
        "list of materials",
        "energy of the material",
        "class of the material",
        "line of the catalogue",
    )
    assert sum(len(block(name).splitlines()) for name in names) < 40  # and one line to export it
    # as those that are there: no other file knows one by its kind
    wanted = re.compile(r"\bgent\b|\bGent\b|\bGENT\b")
    files = [
        *(ROOT / "cpp" / "visviva").rglob("*.?pp"),
        *(ROOT / "cpp" / "bind").rglob("*.?pp"),
        *Path(vv.__file__).parent.rglob("*.py*"),  # the package that is tested, installed or not
    ]
    found = {
        f.name for f in files if f.suffix in {".hpp", ".cpp", ".py", ".pyi"} and wanted.search(f.read_text())
    }
    assert found - {"_core.pyi"} == {
        "material_list.hpp",
        "materials.hpp",
        "rubber.py",
        "__init__.pyi",
    }
