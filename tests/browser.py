"""A browser without a screen, for tests of pages; they are skipped where none is installed."""

from __future__ import annotations

import io
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--window-size=1280,800",
)
NAMES = ("chromium", "google-chrome", "chrome")


@contextmanager
def browser() -> Iterator[Any]:
    """A driver of Chromium; logs what its pages ask for."""
    webdriver = pytest.importorskip("selenium.webdriver")
    program = next(filter(None, map(shutil.which, NAMES)), None)
    driver = shutil.which("chromedriver")
    if program is None or driver is None:
        pytest.skip("no Chromium with its driver is installed")
    options = webdriver.ChromeOptions()
    options.binary_location = program
    options.set_capability("goog:loggingPrefs", {"performance": "ALL", "browser": "ALL"})
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        for flag in (*FLAGS, f"--user-data-dir={profile}"):
            options.add_argument(flag)
        environment = {**os.environ, "HOME": profile}
        service = webdriver.ChromeService(executable_path=driver, env=environment)
        opened = webdriver.Chrome(options=options, service=service)
        opened.set_script_timeout(60)
        try:
            yield opened
        finally:
            opened.quit()


def ready(driver: Any, address: str) -> Any:
    """Open a page and wait until it shows something; returns the driver."""
    from selenium.webdriver.support.ui import WebDriverWait

    driver.get(address)
    told = "return window.visviva ? [visviva.state.ready || false, visviva.state.failed] : [false, '']"
    WebDriverWait(driver, 40).until(lambda d: any(d.execute_script(told)))
    done, trouble = driver.execute_script(told)
    assert done, trouble
    return driver


def pixels(driver: Any) -> NDArray[np.float32]:
    """What the page shows of the motion (height, width, 3)."""
    from matplotlib.image import imread
    from selenium.webdriver.common.by import By

    image = imread(io.BytesIO(driver.find_element(By.ID, "view").screenshot_as_png), format="png")
    return np.asarray(image[..., :3], dtype=np.float32)
