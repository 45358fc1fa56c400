"""Run the examples and write their pages: what they print, their pictures, their source.

    python docs/make_gallery.py [NAME]

runs the examples whose pages are not kept (``kept.py``), one a processor, or one by its name.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from kept import fetch, keep

from visviva.output.page import write_page
from visviva.results.result import audit
from visviva.scene.gallery import example, example_names, first_line
from visviva.study.run import run

HERE = Path(__file__).resolve().parent
GALLERY = HERE / "gallery"
LONGEST = 10.0  # s, of the motions shown
PICTURES = ("picture", "energy", "probes")
"""Of a run; the last is there where something is measured."""
PAGE_SIZE = 4_000_000
"""Bytes of the interactive page of an example, so that the documentation stays small."""
GROUPS = {
    "Mechanisms of rigid bodies": (
        "pendulum", "double_pendulum", "triple_pendulum", "spring_pendulum", "four_bar", "n_four_bar", "slider_crank",
        "bricard", "screw", "crane", "crane_servo", "rope_on_drum",
    ),
    "Bodies that spin": ("free_body", "heavy_top", "lagrange_top", "satellite", "wind_turbine"),
    "Solids, beams and shells": (
        "torus", "cantilever", "flexible_crane", "flexible_slider_crank", "spaghetti", "pinched_cylinder", "snap_roof",
    ),
    "Contact": ("tori", "damped_block"),
    "Heat": ("brake", "tori_thermal", "rubber_heat", "thermal_pendulum", "flying_l", "convection"),
    "Flow and what swims in it": ("cylinder", "cavity", "valve", "valve_3d", "leaf_valve", "hinged_valve"),
    "Mixtures": ("spinodal", "coarsening", "solder", "misfit", "drop_on_wall", "sphere_pattern"),
    "Cracks": ("notch", "surfing", "branching", "thermal_crack"),
}  # fmt: skip
"""Examples by subject; those in none stand under "More"."""

PAGE = """\
{title}
{underline}
{description}

Run it with ``visviva run {name}{settings}``.

.. image:: {name}_picture.png
   :width: 90%

:download:`Turn and play it <{name}_motion.html>`: one page that needs no network.

.. image:: {name}_energy.png
   :width: 90%
{probes}
.. code-block:: text

{audit}

.. literalinclude:: ../../src/visviva/examples/{name}.py
   :language: python
"""

PROBES = """
.. image:: {name}_probes.png
   :width: 90%
"""

INDEX = """\
Gallery
=======
Each page is an example of the package, run when this documentation was built, with the audit of its run
(motions longer than {longest:g} s are cut there). All of them take parameters:
``visviva run NAME --set key=value``.

{groups}

.. toctree::
   :hidden:

{pages}
"""


GROUP = """\
{title}
{underline}
.. grid:: 1 2 3 3
   :gutter: 2

{cards}
"""

CARD = """\
   .. grid-item-card:: {title}
      :link: {folder}{name}
      :link-type: doc
      :img-top: {folder}{name}_picture.png

      {line}
"""


def make_gallery() -> None:
    """Write the pages of all examples and their index."""
    GALLERY.mkdir(exist_ok=True)
    names = example_names()
    missing = [name for name in names if not fetch(name, GALLERY)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(make_alone, reversed(missing)))  # the longest come last by their names
    write(GALLERY / "index.rst", INDEX.format(longest=LONGEST, groups=groups(names), pages=indented(names)))


def groups(names: Sequence[str]) -> str:
    """The examples as cards with their pictures, by subject."""
    grouped = {name for members in GROUPS.values() for name in members}
    subjects = {**GROUPS, "More": tuple(name for name in names if name not in grouped)}
    texts = []
    for title, members in subjects.items():
        cards = "\n".join(card(name) for name in members if name in names)
        if cards:
            texts.append(GROUP.format(title=title, underline="-" * len(title), cards=cards))
    return "\n".join(texts)


def card(name: str, folder: str = "") -> str:
    """An example as a card, with the way to the folder of the gallery."""
    line = first_line(example(name)).replace("`", "")
    return CARD.format(title=name.replace("_", " "), name=name, line=line, folder=folder)


def make_alone(name: str) -> None:
    """Make a page in a process of its own, which has loaded what the page is made of and nothing else."""
    alone = {**os.environ, "OMP_NUM_THREADS": "1"}
    made = subprocess.run(
        [sys.executable, __file__, name], env=alone, capture_output=True, text=True, check=False
    )
    if made.returncode != 0:
        raise RuntimeError(f"the page of {name} was not made:\n{made.stderr}")


def make_and_keep(name: str) -> None:
    """Make the page of an example."""
    page = GALLERY / f"{name}.rst"
    GALLERY.mkdir(exist_ok=True)
    write(page, make_page(name))
    pictures = [png for what in PICTURES if (png := GALLERY / f"{name}_{what}.png").exists()]
    keep(name, [page, *pictures, GALLERY / f"{name}_motion.html"])


def make_page(name: str) -> str:
    """Run an example and put its page together; the pictures go beside it."""
    module = example(name)
    parameters = getattr(module, "GALLERY", {})
    study = module.study(**parameters)
    study.until, study.movie = min(study.until, LONGEST), False
    with tempfile.TemporaryDirectory() as scratch:
        files = Path(scratch) / name
        result = run(study, files, progress=False)
        shown = [what for what in PICTURES if (files / f"{what}.png").exists()]
        for what in shown:
            shutil.copy(files / f"{what}.png", GALLERY / f"{name}_{what}.png")
        write_page(files, GALLERY / f"{name}_motion.html", largest=PAGE_SIZE)
    title = study.title or name
    return PAGE.format(
        title=title,
        underline="=" * len(title),
        description=literal(module.__doc__ or first_line(module)),
        name=name,
        settings="".join(f" --set {key}={value}" for key, value in parameters.items()),
        probes=PROBES.format(name=name) if "probes" in shown else "",
        audit=indented(audit(result).split("\n")),
    )


def literal(text: str) -> str:
    """Text whose single backticks are doubled, as pages want them; pairs of them stay.

    >>> literal("a `b` and ``c``")
    'a ``b`` and ``c``'
    """
    return re.sub(r"(?<!`)`([^`]+)`(?!`)", r"``\1``", text)


def indented(lines: list[str]) -> str:
    """Lines moved to the right, as directives want their content."""
    return "\n".join(f"   {line}" for line in lines)


def write(path: Path, text: str) -> None:
    """Write a file only if that changes it, so that Sphinx does not read it again for nothing."""
    if not path.exists() or path.read_text() != text:
        path.write_text(text)
    else:
        path.touch()


if __name__ == "__main__":
    make_and_keep(sys.argv[1]) if len(sys.argv) > 1 else make_gallery()
