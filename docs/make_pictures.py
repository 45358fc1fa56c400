"""Draw the pictures of the README.

    python docs/make_pictures.py [crane | solids | contact | valve]

writes ``docs/pictures/crane.png``, the crane under way and its energies with the error of their balance,
``docs/pictures/solids.jpg``, the hollow torus in flight and the slider-crank with a flexible rod, and
``docs/pictures/contact.jpg``, two tori in impact and their energies, ``docs/pictures/tori.jpg``, the tori at t = 2 and
t = 5, and ``docs/pictures/valve.jpg``, two flaps in a channel with the curves of their tips over a body-fitted
reference.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import matplotlib.image as image
import numpy as np
from matplotlib.figure import Figure

from visviva.examples import crane, flexible_slider_crank, tori, torus, valve
from visviva.output import RunDirectory
from visviva.output.picture import snapshot
from visviva.output.plot import energy_plot
from visviva.study.run import run

PICTURES = Path(__file__).resolve().parent / "pictures"
MOMENT = 0.9  # s, with the load swung out and still near the crane
TIPS = Path(__file__).resolve().parent.parent / "tests" / "data" / "valve_tip.csv"
CLOSING = 0.8  # s, with the flaps going back
BENT = 0.145  # s, with the rod bent
NEAR = ((1.9, -2.0, 1.35), (0.58, 0.05, -0.15), (0.0, 0.0, 1.0))  # camera of the slider-crank


def draw_crane() -> Path:
    """Run the crane, draw both panels, put them side by side."""
    with tempfile.TemporaryDirectory() as scratch:
        here = Path(scratch)
        files = here / "crane"
        run(crane.study(until=1.2), files, progress=False, pictures=False)
        snapshot(
            files / "trajectory.vtkhdf", here / "left.png", time=MOMENT, trails=("load",), size=(900, 800)
        )
        labels = RunDirectory.open(files).read_labels()
        energy_plot(files / "ledger.csv", here / "right.png", title="Rotary crane, h = 0.01 s", labels=labels)
        return side_by_side([here / "left.png", here / "right.png"], PICTURES / "crane.png")


def draw_solids() -> Path:
    """Run torus and slider-crank, draw their stresses side by side."""
    views = {
        "torus": (torus.study(), None, None),
        "crank": (flexible_slider_crank.study(until=2 * BENT), BENT, NEAR),
    }
    with tempfile.TemporaryDirectory() as scratch:
        here = Path(scratch)
        panels = []
        for name, (study, moment, camera) in views.items():
            run(study, here / name, progress=False, pictures=False)
            panels.append(here / f"{name}.png")
            snapshot(
                here / name / "trajectory.vtkhdf",
                panels[-1],
                time=moment,
                field="von_mises",
                camera=camera,
                size=(900, 700),
            )
        return side_by_side(panels, PICTURES / "solids.jpg")


def draw_contact() -> Path:
    """Run the coarse tori through their impact; a moment of it beside the energies, and two moments of it."""
    with tempfile.TemporaryDirectory() as scratch:
        here = Path(scratch)
        files = here / "tori"
        run(tori.study(mesh="coarse", step=0.02), files, progress=False)
        moments = [files / f"picture-{moment}.png" for moment in (2, 5)]
        side_by_side(moments, PICTURES / "tori.jpg")
        snapshot(files / "trajectory.vtkhdf", here / "left.png", time=2.0, field="von_mises", size=(900, 700))
        energy_plot(files / "ledger.csv", here / "right.png", title="Impact of two tori, h = 0.02 s")
        return side_by_side([here / "left.png", here / "right.png"], PICTURES / "contact.jpg")


def draw_valve(files: Path | None = None) -> Path:
    """Run two flaps, about five minutes, or take a run's files; streamlines beside the way of the tips."""
    with tempfile.TemporaryDirectory() as scratch:
        here = Path(scratch)
        if files is None:
            files = here / "valve"
            run(valve.study(), files, progress=False, pictures=False)
        snapshot(
            files / "trajectory.vtkhdf",
            here / "left.png",
            time=CLOSING,
            field="velocity",
            size=(1300, 620),
        )
        plot_tips(files / "probes.csv", here / "right.png")
        return side_by_side([here / "left.png", here / "right.png"], PICTURES / "valve.jpg")


def plot_tips(probes: Path, png: Path) -> None:
    """Displacements of the upper tip over those of the body-fitted reference, digitised twice."""
    ours = np.genfromtxt(probes, delimiter=",", names=True)
    reference = np.genfromtxt(TIPS, delimiter=",", names=True, skip_header=1)
    figure = Figure(figsize=(6, 4.4), dpi=140)
    axes = figure.add_subplot(xlabel="time [s]", ylabel="displacement of the upper tip")
    for axis, color in (("x", "#4c78a8"), ("y", "#f58518")):
        axes.plot(ours["time"], ours[f"upper_tip_{axis}"], color=color, label=f"u{axis}, visviva")
        for source, mark in (("a", "o"), ("b", "x")):
            values = reference[f"u{axis}_{source}"]
            axes.plot(reference["t"], values, mark, color=color, label=f"u{axis}, reference ({source})")
    axes.set_ylim(-0.02, 0.8)
    axes.legend(fontsize=8, loc="upper right", ncols=2)
    axes.grid(alpha=0.3)
    figure.savefig(png)


def side_by_side(panels: list[Path], target: Path) -> Path:
    """One picture from several, scaled to equal height; in few colours where a PNG shall stay small."""
    pictures = [image.imread(panel) for panel in panels]
    ratios = [p.shape[1] / p.shape[0] for p in pictures]
    figure = Figure(figsize=(10, 10 / sum(ratios)), dpi=120)
    axes = figure.subplots(1, len(panels), width_ratios=ratios)
    for axis, picture in zip(axes, pictures, strict=True):
        axis.imshow(picture, interpolation="lanczos")
        axis.set_axis_off()
    figure.subplots_adjust(left=0, right=1, bottom=0, top=1, wspace=0.01)
    figure.savefig(target)
    if target.suffix != ".png":
        return target
    from PIL import Image

    few = Image.open(target).convert("RGB")
    few = few.quantize(255, Image.Quantize.MAXCOVERAGE, kmeans=1)  # keeps the hues of thin lines
    few.save(target, optimize=True)
    return target


if __name__ == "__main__":
    drawn = {"crane": draw_crane, "solids": draw_solids, "contact": draw_contact, "valve": draw_valve}
    for name in sys.argv[1:] or drawn:
        path = drawn[name]()
        print(f"{path} {path.stat().st_size / 1000:.0f} kB")
