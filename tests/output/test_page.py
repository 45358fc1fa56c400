"""A run as one page: what stands in it, how it is thinned, and what a browser shows of it."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from browser import browser, pixels, ready
from test_static_runs import truss

import visviva as vv
from visviva.cli import main
from visviva.output import RunDirectory, Surface, Trajectory, read_table
from visviva.output.page import write_page
from visviva.output.page_frames import STEPS, Frames, quantised, restored
from visviva.output.page_shapes import shape_of
from visviva.study.run import run


@pytest.fixture(scope="module")
def swinging(tmp_path_factory):
    """A run of an elastic bar that swings at a pin beside a ball on a rope."""
    path = tmp_path_factory.mktemp("runs") / "bar & co"
    rubber = vv.NeoHooke(young=2e4, poisson=0.3)
    bar = vv.Solid(
        name="bar", mesh=vv.BoxMesh(size=(2, 0.4, 0.4), counts=(6, 2, 2)), material=rubber, density=10
    )
    ball = vv.RigidBody(
        name="ball", shape=vv.Sphere(0.2), density=100, position=(1, 2, 0), velocity=(1, 0, 1)
    )
    system = vv.System([bar, ball, vv.Fixed(solid=bar, nodes="x0"), vv.Gravity(acceleration=(0, 0, -9.81))])
    study = vv.Study(
        system, until=0.4, step=0.02, fields=("von_mises",), title="A bar </script> & a ball", units="SI"
    )
    study.probes = {"tip": vv.Position(of=ball)}
    run(study, path, progress=False, pictures=False)
    return path


BAR = "[...document.querySelectorAll('#parts label')].find(e => e.textContent == 'bar').firstChild.click()"


def about(text):
    return json.loads(re.search('<script id="about" type="application/json">(.*?)</script>', text, re.S)[1])


def test_numbers_are_kept_to_16_bits():
    rng = np.random.default_rng(1)
    values = rng.normal(size=(1001, 3)) * [1, 1e6, 1e-9] + [0, 5, 1e-9]
    back = restored(quantised(values), 3)[:1001]
    assert (np.abs(back - values) <= 0.51 * np.ptp(values, axis=0) / STEPS).all()
    holes = np.where(rng.random(1001) < 0.2, np.nan, values[:, 0])
    np.testing.assert_array_equal(np.isnan(restored(quantised(holes), 1)[:1001]), np.isnan(holes))
    assert np.isnan(restored(quantised(np.full(5, np.nan)), 1)[:5]).all()


def test_corners_are_split_at_sharp_edges_alone():
    cube = vv.BoxMesh(size=(1, 1, 1), counts=(3, 3, 3)).build()
    shape = shape_of(Surface("cube", cube.points, [cube.cells["hex8"]], [12]))
    assert len(shape.corners) == 6 * 16  # each side has its own
    assert len(shape.triangles) == 6 * 9 * 2
    assert len(shape.edges) == 12 * 3
    assert len(shape.mesh) == 6 * 9 * 2  # every edge of a face lies between two
    angles = np.linspace(0, 2 * np.pi, 37)[:-1]
    ring = np.array([[np.cos(a), np.sin(a), z] for z in (0, 1) for a in angles])
    k = np.arange(36)
    tube = shape_of(Surface("tube", ring, [np.stack([k, (k + 1) % 36, (k + 1) % 36 + 36, k + 36], axis=1)]))
    assert len(tube.corners) == 72
    assert len(tube.edges) == 72  # its two rims


def test_a_surface_turned_inside_out_here_and_there_is_smoothed():
    square = Surface("square", [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 3, 2]])
    shape = shape_of(square)
    assert len(shape.corners) == 4
    assert sorted(map(sorted, shape.edges.tolist())) == [[0, 1], [0, 3], [1, 2], [2, 3]]


def test_frames_hold_positions_and_fields(swinging):
    with Trajectory(RunDirectory(swinging).trajectory) as motion:
        frames = Frames(motion)
        n = frames.layout()["points"]
        data = frames.frame(5)
        head = 48 + -(-6 * n // 8) * 8
        np.testing.assert_allclose(restored(data[:head], 3)[:n], frames.positions(5), atol=1e-4)
        k = frames.fields.index("von_mises")
        each = 16 + -(-2 * n // 8) * 8
        mises = restored(data[head + k * each : head + (k + 1) * each], 1)[:n]
        wanted = frames.values("von_mises", 5)
        np.testing.assert_allclose(mises, wanted, atol=np.nanmax(wanted) / STEPS)
        assert len(data) == head + len(frames.fields) * each


def test_the_page_asks_for_nothing(swinging, tmp_path):
    text = write_page(swinging, tmp_path / "page.html").read_text()
    assert not re.search(r"https?://|src=|@import|url\(", text)
    assert text.count("</script>") == 3  # titles and names end none
    assert about(text)["title"] == "A bar </script> & a ball"
    assert "<title>A bar &lt;/script&gt; &amp; a ball</title>" in text
    assert [part["name"] for part in about(text)["parts"]] == ["ball", "bar"]
    assert [plot["title"] for plot in about(text)["plots"]][1:] == ["tip [m]"]


def test_frames_are_thinned_to_a_size(swinging, tmp_path):
    whole = write_page(swinging, tmp_path / "whole.html")
    n = len(about(whole.read_text())["times"])
    largest = int(0.75 * whole.stat().st_size)
    small = write_page(swinging, tmp_path / "small.html", largest=largest)
    times = about(small.read_text())["times"]
    assert small.stat().st_size <= largest
    assert 2 <= len(times) < n
    assert (times[0], times[-1]) == (0.0, pytest.approx(0.4))
    with pytest.raises(vv.InputError, match="one frame takes"):
        write_page(swinging, tmp_path / "none.html", largest=1000)


def test_command(swinging, tmp_path, capsys):
    assert main(["html", str(swinging), "--out", str(tmp_path / "p.html")]) == 0
    assert (tmp_path / "p.html").exists()
    assert str(tmp_path / "p.html") in capsys.readouterr().out
    assert main(["html", str(tmp_path)]) == 2
    assert "holds no run" in capsys.readouterr().err


def test_a_browser_plays_it(swinging, tmp_path):
    """Pixels change with time, field, parts and cuts; values are those stored; nothing is asked for."""
    page = write_page(swinging, tmp_path / "page.html")
    with browser() as driver:
        ready(driver, page.as_uri())
        show = "const done = arguments[1]; visviva.show(arguments[0]).then(done)"
        choose = "const e = document.getElementById(arguments[0]); e.value = arguments[1]; e.onchange({target: e});"
        first = pixels(driver)
        driver.execute_async_script(show, 10)
        later = pixels(driver)
        driver.execute_script(choose, "field", "")
        plain = pixels(driver)
        driver.execute_script(choose, "cut", "0")
        cut = pixels(driver)
        driver.execute_script(choose, "cut", "")
        driver.execute_script(BAR)
        without = pixels(driver)
        for before, after in ((first, later), (later, plain), (plain, cut), (plain, without)):
            assert (np.abs(before - after).max(axis=2) > 0.1).mean() > 0.002
        driver.execute_script(BAR)
        np.testing.assert_array_equal(pixels(driver), plain)
        driver.execute_script(choose, "field", "von_mises")
        read = driver.execute_script("return [visviva.state.frame, Array.from(visviva.state.numbers.fields["
                                     "visviva.about.fields.findIndex(f => f.name == 'von_mises')])]")  # fmt: skip
        assert asked(driver) == {page.as_uri()}
    with Trajectory(RunDirectory(swinging).trajectory) as motion:
        wanted = Frames(motion).values("von_mises", 10)
    values = np.array([np.nan if v is None else v for v in read[1]], dtype=float)
    assert read[0] == 10
    np.testing.assert_allclose(values, wanted, atol=2 * np.nanmax(wanted) / STEPS)


def test_curves_of_paths_are_those_of_the_state_that_is_shown(tmp_path):
    """Loads fall behind a limit point: they are places of curves, and states are what values are looked up by."""
    study = truss()
    study.scheme = vv.ArcLength(most=40)
    run(study, tmp_path / "path", progress=False, pictures=False)
    page = write_page(tmp_path / "path", tmp_path / "page.html")
    table = read_table(tmp_path / "path" / "probes.csv")
    last = len(table["time"]) - 1
    load, height = table["time"], table["height_z"]
    shown = about(page.read_text())["plots"][1]
    assert shown["times"] == list(range(last + 1))
    assert shown["places"] == pytest.approx(load, rel=1e-5)
    assert np.diff(load).min() < 0
    legend = "return [...document.querySelectorAll('.legend')][1].textContent"
    with browser() as driver:
        ready(driver, page.as_uri())
        for k in (0, last // 3, last):
            driver.execute_async_script("visviva.show(arguments[0]).then(arguments[1])", k)
            told = driver.execute_script(legend)
            assert float(re.search(r"z (\S+)$", told)[1].replace("\u2212", "-")) == pytest.approx(
                height[k], abs=2e-3
            )


def asked(driver):
    """Addresses that the page asked for, data within it left out."""
    events = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    sent = [e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"]
    return {url for url in sent if not url.startswith(("data:", "blob:", "chrome:"))}
