"""Compare schemes: the total energy and angular momentum of a tossed rubber block over 10,000 steps.

    python docs/make_schemes.py [steps]

writes ``docs/pictures/schemes.png`` and prints the figures. One element of 2 x 1 x 0.6, neo-Hooke with E = 200 and
Poisson's ratio 0.3, density 1, spinning with (2, 3, -1.5), in steps of 0.05: about eight to a period of its lowest
frequencies, two to one of its highest. A scheme ends where the block turns inside out or Newton's method fails.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

import visviva as vv
from visviva.analysis.march import advance, begin
from visviva.output.plot import STYLE
from visviva.output.view import PALETTE

TARGET = Path(__file__).resolve().parent / "pictures" / "schemes.png"
STEPS = (0.05, 0.1)
SCHEMES = {
    "energy–momentum": vv.EnergyMomentum(),
    "midpoint": vv.Midpoint(),
    "trapezoidal": vv.GeneralizedAlpha(1.0),
}


def block() -> vv.System:
    """The block of the tests of conservation."""
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(2, 1, 0.6), counts=(1, 1, 1)),
        material=vv.NeoHooke(young=200.0, poisson=0.3),
        density=1.0,
        velocity=(0.1, 0.05, 0.2),
        angular_velocity=(2.0, 3.0, -1.5),
        name="block",
    )
    return vv.System([solid], vv.Newton(tolerance=1e-13))


def toss(scheme: vv.Scheme, step: float, steps: int) -> tuple[vv.Result, str]:
    """The run as far as it goes, and how it ended; a step that fails is halved up to six times."""
    result, books = begin(block(), scheme)
    try:
        for _ in advance(result, books, until=step * steps, step=step):
            pass
    except vv.RunError as failure:
        return result, f"ends at t = {result.system.time:.4g}: {str(failure).splitlines()[0]}"
    return result, "goes on"


def energy_ratio(result: vv.Result) -> np.ndarray:
    """Total energy over that at the start."""
    total = result.ledger["total"]
    return total / total[0]


def turning_error(result: vv.Result) -> np.ndarray:
    """Change of the angular momentum over its size at the start."""
    L = np.column_stack([result.ledger[f"angular_{c}"] for c in "xyz"])
    return np.linalg.norm(L - L[0], axis=1) / np.linalg.norm(L[0])


def draw(runs: dict[float, dict[str, vv.Result]]) -> None:
    """Energies above, and the errors of energy and angular momentum below, for every step size."""
    labels = ("energy over initial", "error of energy", "error of angular momentum")
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10, 7.5), dpi=110, layout="constrained")
        panels = figure.subplots(3, len(runs), sharex=True, sharey="row", squeeze=False)
        for axes, (step, results) in zip(panels.T, runs.items(), strict=True):
            last = max(result.ledger["time"][-1] for result in results.values())
            for (name, result), color in reversed(list(zip(results.items(), PALETTE, strict=False))):
                draw_run(axes, result, step, name, color, result.ledger["time"][-1] < 0.999 * last)
            axes[0].set_title(f"step {step:g}")
            axes[0].set_ylim(0.8, 1.5)
            axes[-1].set_xlabel("time over step")
        for axis, text in zip(panels[:, 0], labels, strict=True):
            axis.set_ylabel(text)
        panels[0, 0].legend(loc="upper left")
        figure.savefig(TARGET)
    from PIL import Image

    Image.open(TARGET).convert("RGB").quantize(128).save(TARGET, optimize=True)


def draw_run(axes: np.ndarray, result: vv.Result, step: float, name: str, color: str, ended: bool) -> None:
    """One scheme in the three panels of a step size, with a cross where it ended."""
    number = result.ledger["time"][1:] / step
    ratio, turning = energy_ratio(result)[1:], turning_error(result)[1:]
    for axis, values in zip(axes, (ratio, np.abs(ratio - 1), turning), strict=True):
        axis.plot(number, values, color=color, lw=0.8, label=name)
        axis.set_xscale("log")
        if ended:
            axis.plot(number[-1], values[-1], "x", color=color, ms=9, mew=2)
    for axis in axes[1:]:
        axis.set_yscale("log")


def main() -> None:
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    runs: dict[float, dict[str, vv.Result]] = {}
    for step in STEPS:
        for name, scheme in SCHEMES.items():
            result, end = toss(scheme, step, steps)
            runs.setdefault(step, {})[name] = result
            energy, turning = np.abs(energy_ratio(result) - 1).max(), turning_error(result).max()
            s = result.statistics
            print(
                f"step {step:<5g} {name:16s} steps {s.steps:6d}, halved {s.rejected:5d}: largest error of energy "
                f"{energy:.1e}, of angular momentum {turning:.1e}; {end}"
            )
    draw(runs)
    print(f"{TARGET} {TARGET.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
