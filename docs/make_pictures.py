"""Draw the picture of the README: the crane under way, and its energies with the error of the balance.

    python docs/make_pictures.py

writes ``docs/pictures/crane.png`` (less than 300 kB) from a run of ``visviva run crane``.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import matplotlib.image as image
from matplotlib.figure import Figure

from visviva.examples import crane
from visviva.output.picture import snapshot
from visviva.output.plot import energy_plot
from visviva.run import run

TARGET = Path(__file__).resolve().parent / "pictures" / "crane.png"
MOMENT = 0.9  # s, with the load swung out and still near the crane


def main() -> None:
    """Run the crane, draw both panels, put them side by side."""
    with tempfile.TemporaryDirectory() as scratch:
        here = Path(scratch)
        files = here / "crane"
        run(crane.study(until=1.2), files, progress=False, pictures=False)
        snapshot(
            files / "trajectory.vtkhdf", here / "left.png", time=MOMENT, trails=("load",), size=(900, 800)
        )
        energy_plot(files / "ledger.csv", here / "right.png", title="Rotary crane, h = 0.01 s")
        side_by_side([here / "left.png", here / "right.png"], TARGET)
    print(f"{TARGET} {TARGET.stat().st_size / 1000:.0f} kB")


def side_by_side(panels: list[Path], target: Path) -> None:
    """One picture from several, scaled to equal height, in few colours to keep the file small."""
    pictures = [image.imread(panel) for panel in panels]
    ratios = [p.shape[1] / p.shape[0] for p in pictures]
    figure = Figure(figsize=(10, 10 / sum(ratios)), dpi=120)
    axes = figure.subplots(1, len(panels), width_ratios=ratios)
    for axis, picture in zip(axes, pictures, strict=True):
        axis.imshow(picture, interpolation="lanczos")
        axis.set_axis_off()
    figure.subplots_adjust(left=0, right=1, bottom=0, top=1, wspace=0.01)
    figure.savefig(target)
    from PIL import Image

    Image.open(target).convert("RGB").quantize(192).save(target, optimize=True)


if __name__ == "__main__":
    main()
