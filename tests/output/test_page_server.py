"""The viewer in the browser: who may ask what, and that it follows a run that goes on."""

from __future__ import annotations

import json
import threading
import urllib.request
from contextlib import contextmanager
from urllib.error import HTTPError

import numpy as np
import pytest
from browser import browser, pixels, ready

import visviva as vv
from output.scenes import SCENE, moved
from visviva.output import RunDirectory, Trajectory, TrajectoryWriter
from visviva.output.page_frames import Frames
from visviva.output.page_server import PageServer, RunPages


@contextmanager
def serving(path, **options):
    """A server in a thread of its own."""
    server = PageServer(RunPages(path, **options))
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05})
    thread.start()
    try:
        yield server
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@pytest.fixture
def growing(tmp_path):
    """A run with three frames, and its writer."""
    files = RunDirectory.create(tmp_path / "run")
    with TrajectoryWriter(files.trajectory, SCENE) as writer:
        for k in range(3):
            writer.append(0.1 * k, moved(0.1 * k))
        yield files, writer


def get(address, path="/", host=None, method="GET"):
    where, token = address.split("/?")
    request = urllib.request.Request(f"{where}{path}?{token}", method=method)
    if host:
        request.add_header("Host", host)
    with urllib.request.urlopen(request, timeout=10) as answer:
        return answer.read()


def refused(*args, **options):
    with pytest.raises(HTTPError) as found:
        get(*args, **options)
    return found.value.code


def test_only_who_has_the_token_reads_and_nobody_writes(growing):
    files, _ = growing
    with serving(files.path) as server:
        address = server.address
        assert server.server_address[0] == "127.0.0.1"
        assert b"<title>run</title>" in get(address)
        with Trajectory(files.trajectory) as motion:
            assert get(address, "/frame/1") == Frames(motion).frame(1)
        for path in (
            "/frame/3",
            "/frame/-1",
            "/frame/x",
            "/state.h5",
            "/../run/state.h5",
            "/frame/../../etc/passwd",
        ):
            assert refused(address, path) == 404
        for other in (address[:-1], address.split("token=")[0] + "token=", address.split("?")[0] + "?"):
            assert refused(other) == 403
        assert refused(address, host="elsewhere.example") == 403
        assert {refused(address, method=m) for m in ("POST", "PUT", "DELETE")} == {501}


def test_every_viewer_has_a_token_of_its_own(growing):
    files, _ = growing
    tokens = {RunPages(files.path).token for _ in range(3)}
    assert len(tokens) == 3
    assert min(map(len, tokens)) >= 32


def test_news_of_a_run_that_goes_on(growing):
    files, writer = growing
    with serving(files.path, live=True) as server:
        assert len(json.loads(get(server.address, "/news"))["times"]) == 3
        for k in range(3, 200):  # beyond the room reserved at first, into a file of its own
            writer.append(0.1 * k, moved(0.1 * k))
        assert len(json.loads(get(server.address, "/news"))["times"]) == 200
        assert get(server.address, "/frame/199")


def test_another_run_in_the_directory_is_told(growing):
    files, writer = growing
    with serving(files.path, live=True) as server:
        writer.close()
        files.trajectory.unlink()
        with TrajectoryWriter(files.trajectory, SCENE[:1]) as other:
            other.append(0.0, [SCENE[0].points])
        with pytest.raises(HTTPError) as found:
            get(server.address, "/news")
        assert "another run" in found.value.read().decode()


def test_a_port_that_is_taken(growing):
    files, _ = growing
    with serving(files.path) as server, pytest.raises(vv.InputError, match="choose another port"):
        PageServer(RunPages(files.path), port=server.server_address[1])


def test_a_browser_follows_a_run(growing):
    files, writer = growing
    from selenium.webdriver.support.ui import WebDriverWait

    with serving(files.path, live=True) as server, browser() as driver:
        ready(driver, server.address)
        assert driver.execute_script("return visviva.about.times.length") == 3
        before = pixels(driver)
        for k in range(3, 20):
            writer.append(0.1 * k, moved(0.1 * k))
        WebDriverWait(driver, 20).until(lambda d: d.execute_script("return visviva.state.shown") == 19)
        after = pixels(driver)
        assert (np.abs(before - after).max(axis=2) > 0.1).mean() > 0.002
        slide = "const s = document.getElementById('slider'); s.value = 2; s.oninput()"
        driver.execute_script(slide)
        WebDriverWait(driver, 20).until(lambda d: d.execute_script("return visviva.state.shown") == 2)
        writer.append(2.0, moved(2.0))
        WebDriverWait(driver, 20).until(lambda d: d.execute_script("return visviva.about.times.length") == 21)
        assert (
            driver.execute_script("return visviva.state.shown") == 2
        )  # who has moved the slider stays there


def test_view_of_a_result():
    ball = vv.RigidBody(shape=vv.Sphere(0.1), density=1.0, velocity=(1, 0, 0))
    page = vv.simulate(vv.System([ball]), until=0.2, step=0.1).view()
    assert page._repr_html_().startswith("<iframe srcdoc=")
    assert len(repr(page)) < 80
