"""A headless browser for pages that the project writes: Chromium without a network, by Playwright."""

from __future__ import annotations

import base64
import io
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

NAMES = ("chromium", "chromium-browser", "google-chrome")
"""Names under which systems have the browser."""

ARGUMENTS = """
    --no-sandbox --disable-quic --no-first-run --disable-background-networking --disable-component-update
    --disable-sync --use-angle=swiftshader --enable-unsafe-swiftshader
""".split()
"""Arguments without which it asks the network for things, or draws nothing without a graphics card."""

WIDE, NARROW = (900, 480), (360, 640)
"""Sizes of windows (pixels)."""


@contextmanager
def chromium() -> Iterator[Any]:
    """Yield a running browser."""
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - only what draws pages needs it

    executable = next((path for name in NAMES if (path := shutil.which(name))), None)
    assert executable, f"tests of pages need one of {', '.join(NAMES)}"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=ARGUMENTS)
        try:
            yield browser
        finally:
            browser.close()


class OpenPage:
    """A page in the browser, with all that it says and asks for.

    Attributes:
        page: The page of Playwright.
        messages: Warnings and errors on its console, and uncaught errors.
        requests: Addresses that it has asked for, but for its own.
    """

    def __init__(self, browser: Any, size: tuple[int, int] = WIDE) -> None:
        self.page = browser.new_page(viewport={"width": size[0], "height": size[1]})
        self.page.set_default_timeout(60_000)
        self.messages: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", self._listen)
        self.page.on("pageerror", lambda error: self.messages.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))

    def _listen(self, message: Any) -> None:
        """Keep warnings and errors; those of the software renderer about its own speed do not count."""
        if message.type in ("error", "warning") and "GPU stall" not in message.text:
            self.messages.append(message.text)

    def open(self, file: Path) -> OpenPage:
        """Open a file and wait until it has drawn a picture."""
        self.page.goto(file.as_uri())
        self.page.wait_for_selector("canvas")
        self.settle()
        self.requests.remove(file.as_uri())
        return self

    def settle(self) -> None:
        """Wait until two pictures have been drawn."""
        self.page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def picture(self) -> NDArray[np.float64]:
        """Return the picture as (height, width, 3) values from 0 to 1."""
        self.settle()
        import matplotlib.image  # noqa: PLC0415 - which takes a second

        data = self.page.evaluate("document.querySelector('.kg-stage canvas').toDataURL()").partition(",")[2]
        return np.asarray(matplotlib.image.imread(io.BytesIO(base64.b64decode(data))), np.float64)[..., :3]

    def close(self) -> None:
        """Close the page."""
        self.page.close()
