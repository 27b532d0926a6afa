"""Writes the demonstration of gimbal lock to build/live/, and its picture to docs/gimbal-lock.png.

The picture shows the page `SHOWN` seconds of motion after its start, which it reaches by steps, not by time.
"""

from __future__ import annotations

import io
from pathlib import Path

from PIL import Image

from benchmarks.gimbal_lock.page import STEP, gimbal_lock
from tests.support.browser import OpenPage, chromium

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "build" / "live" / "gimbal-lock.html"
PICTURE = ROOT / "docs" / "gimbal-lock.png"

SHOWN = 2.0
"""Time of the picture (s)."""

SIZE = (1200, 530)
"""Size of the picture (pixels)."""

COLORS = 200
"""Colours of the picture, whose file is a third of what it would be with all."""

MEASUREMENTS = 4
"""Measurements of evaluations a second, of which the page shows the fastest."""

PICTURES = 40
"""States between the start and the picture in which errors are drawn."""


def main() -> None:
    """Write the page and its picture."""
    page = gimbal_lock(print)
    PAGE.parent.mkdir(parents=True, exist_ok=True)
    page.save(PAGE)
    still = PAGE.with_name("gimbal-lock-still.html")
    page.save(still, play=False)
    with chromium() as browser:
        found = OpenPage(browser, SIZE).open(still)
        for _ in range(PICTURES):
            found.page.evaluate(f"kanegenWeb.shown.advance({round(SHOWN / STEP / PICTURES)})")
            found.page.evaluate("kanegenWeb.shown.show()")
        found.page.wait_for_function(f"kanegenWeb.shown.referenceRow.rates.length >= {MEASUREMENTS}")
        found.settle()
        with Image.open(io.BytesIO(found.page.screenshot())) as picture:
            picture.convert("RGB").quantize(COLORS).save(PICTURE, optimize=True)
        found.close()
    still.unlink()
    print(f"wrote {PAGE} and {PICTURE}")


if __name__ == "__main__":
    main()
