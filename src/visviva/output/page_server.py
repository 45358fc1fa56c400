"""The page of a run, served to browsers on this machine: frames as they are asked for, news of a run that goes on."""

from __future__ import annotations

import hmac
import json
import secrets
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Lock
from typing import Any
from urllib.parse import parse_qs, urlsplit

from visviva.base.errors import InputError, VisvivaError
from visviva.output.directory import RunDirectory
from visviva.output.page import about, changing, compose
from visviva.output.page_frames import Frames
from visviva.output.trajectory import Trajectory

LOOPBACK = "127.0.0.1"
NOBODY = 404
REFUSED = 403


class RunPages:
    """Server of a run to a browser, read-only. Memory does not grow with the frames of the run.

    Parameters
    ----------
    directory
        Of the run.
    live
        Look for more frames of a run that goes on.

    Raises
    ------
    InputError
        If there is no run in the directory, or no motion yet.
    """

    def __init__(self, directory: str | Path, live: bool = False, field: str | None = None) -> None:
        self.files, self.live, self.field = RunDirectory.open(directory), live, field
        self.token = secrets.token_urlsafe(24)
        self._lock = Lock()  # HDF5 reads one thing at a time
        self._frames = Frames(Trajectory(self.files.trajectory))
        self._seen = self._stamp()

    def answer(self, path: str) -> tuple[str, bytes]:
        """Kind and bytes of what is found under a path.

        Raises
        ------
        InputError
            If there is nothing.
        """
        with self._lock:
            if path == "/":
                return "text/html; charset=utf-8", self._page().encode()
            if path == "/news":
                return "application/json", self._news().encode()
            number = path.removeprefix("/frame/")
            if number.isdecimal() and int(number) < len(self._frames.motion.times):
                return "application/octet-stream", self._frames.frame(int(number))
        raise InputError(f"there is no {path}")

    def close(self) -> None:
        """Close the file of the motion."""
        self._frames.motion.close()

    def _page(self) -> str:
        self._follow()
        rest = {**about(self._frames, self.files), "live": self.live}
        if self.field is not None:
            rest["first"] = self.field
        return compose(rest, [], self.token)

    def _news(self) -> str:
        self._follow()
        labels = self.files.read_labels() if self.files.labels.exists() else self._frames.motion.labels
        return json.dumps(changing(self._frames, self.files, labels), allow_nan=False)

    def _follow(self) -> None:
        """Take a later reading of the file, where there is more in it."""
        stamp = self._stamp()
        if not self.live or stamp == self._seen:
            return
        self._frames.motion.close()  # HDF5 would show an open file as it was when it was opened
        counts = [len(surface.points) for surface in self._frames.motion.surfaces]
        self._frames.motion = later = Trajectory(self.files.trajectory)
        if [len(surface.points) for surface in later.surfaces] != counts:
            raise InputError("another run has been started in the directory; start visviva view again")
        self._seen = stamp

    def _stamp(self) -> tuple[int, ...]:
        status = self.files.trajectory.stat()
        return status.st_ino, status.st_size, status.st_mtime_ns


class Handler(BaseHTTPRequestHandler):
    """Answers who knows the token, and nothing but questions: there is no way to write."""

    server: PageServer
    protocol_version = "HTTP/1.1"

    def do_GET(self) -> None:
        address = urlsplit(self.path)
        given = parse_qs(address.query).get("token", [""])[0]
        if not hmac.compare_digest(given.encode(), self.server.pages.token.encode()) or not self._is_here():
            self._send(REFUSED, "text/plain", b"the address lacks its token, or is not of this machine")
            return
        try:
            kind, content = self.server.pages.answer(address.path)
        except (VisvivaError, OSError) as error:
            self._send(NOBODY, "text/plain; charset=utf-8", str(error).encode())
            return
        self._send(200, kind, content)

    def _is_here(self) -> bool:
        """Another site whose name was bent to this machine gives itself away by that name."""
        return self.headers.get("Host", "").rsplit(":", 1)[0] in self.server.names

    def _send(self, code: int, kind: str, content: bytes) -> None:
        self.send_response(code)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_: Any) -> None:
        """Say nothing: every frame would be a line, with the token in it."""


class PageServer(ThreadingHTTPServer):
    """Serves a run on this machine alone, unless another address is given.

    Parameters
    ----------
    pages
        The run.
    host, port
        Where it listens; any free port for 0.

    Examples
    --------
    >>> import tempfile, visviva as vv
    >>> ball = vv.RigidBody(shape=vv.Sphere(0.1), density=1.0, velocity=(1, 0, 0))
    >>> folder = tempfile.mkdtemp() + "/ball"
    >>> vv.simulate(vv.System([ball]), until=0.2, step=0.1).write(folder)
    >>> with PageServer(RunPages(folder)) as server:
    ...     server.address.startswith("http://127.0.0.1:")
    True
    """

    daemon_threads = True

    def __init__(self, pages: RunPages, host: str = LOOPBACK, port: int = 0) -> None:
        self.pages = pages
        self.names = {host, "localhost", LOOPBACK}
        try:
            super().__init__((host, port), Handler)
        except OSError as error:
            raise InputError(
                f"cannot listen at {host}:{port} ({error.strerror}); choose another port"
            ) from error

    @property
    def address(self) -> str:
        """Address to open; the token in it is the key."""
        return f"http://{self.server_address[0]!s}:{self.server_address[1]}/?token={self.pages.token}"

    def server_close(self) -> None:
        """Stop listening, and close the file of the motion."""
        super().server_close()
        self.pages.close()
