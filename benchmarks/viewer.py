"""The viewer in a browser without a screen: how many moments a second the slider shows, and what memory that takes.

    PYTHONPATH=src:tests python benchmarks/viewer.py [FRAMES] [CELLS]

200 frames of a block of 22 x 22 x 23 cells (36,501 unknowns) by default. Needs Chromium, its driver and selenium.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
from browser import browser, ready

import visviva as vv
from visviva.output import RunDirectory, Surface, TrajectoryWriter
from visviva.output.page import write_page
from visviva.output.page_server import PageServer, RunPages

SLIDE = """
const done = arguments[1], s = document.getElementById('slider');
(async () => {
  const began = performance.now();
  for (const k of arguments[0]) {
    s.value = k; s.oninput();
    while (visviva.state.shown !== k) await new Promise((go) => setTimeout(go, 0));
    await new Promise(requestAnimationFrame);
  }
  done([performance.now() - began, performance.memory.usedJSHeapSize]);
})();
"""


def write(folder: Path, frames: int, cells: int) -> int:
    """A block that bends and twists, with velocities and a scalar; returns the number of its unknowns."""
    mesh = vv.BoxMesh(size=(3, 1, 1), counts=(cells, cells, cells + 1)).build()
    block = Surface("block", mesh.points, [mesh.cells["hex8"]], [12])
    files = RunDirectory.create(folder)
    x, y, z = mesh.points.T
    with TrajectoryWriter(files.trajectory, [block], frames) as writer:
        for k in range(frames):
            t = 2 * np.pi * k / frames
            up = np.column_stack([0 * x, 0.1 * x**2 * np.sin(t), 0.1 * x * y * np.cos(2 * t)])
            data = {"displacement": up, "velocity": up[:, ::-1], "von_mises": np.abs(up @ [1, 2, 3]) * z}
            writer.append(0.01 * k, [mesh.points + up], data)
    return 3 * len(x)


def measured(driver: object, address: str, order: list[int]) -> str:
    """Moments a second over the slider's places, and the memory of the page's script."""
    ready(driver, address)
    milliseconds, heap = driver.execute_async_script(SLIDE, order)  # type: ignore[attr-defined]
    return (
        f"{1000 * len(order) / milliseconds:6.1f} moments a second, {heap / 1e6:6.0f} MB of the page's script"
    )


def main(frames: int = 200, cells: int = 22) -> None:
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / "block"
        print(f"{write(folder, frames, cells)} unknowns, {frames} frames")
        order = np.random.default_rng(0).permutation(frames).tolist()
        server = PageServer(RunPages(folder))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        with browser() as driver:
            print("served:    ", measured(driver, server.address, order))
        used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
        print(f"            {used:.0f} MB in the process that serves, at most")
        began = time.perf_counter()
        page = write_page(folder)
        print(
            f"page:       {page.stat().st_size / 1e6:.1f} MB, written in {time.perf_counter() - began:.1f} s"
        )
        with browser() as driver:
            shown = page.read_text().split('id="frames"')[1].split("</script>")[0].count("\n") + 1
            print(f"            {shown} frames")
            print("            ", measured(driver, page.as_uri(), np.argsort(order[:shown]).tolist()))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
