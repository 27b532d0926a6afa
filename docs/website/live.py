"""Pages to turn and to play: every motion of the gallery in three dimensions, and the passage of gimbal lock.

They are large beside the pages of Markdown, so only `make docs` makes them, and the site alone links to them.
What was made is kept in build/live until its model or the programs change.
"""

import shutil
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util import logging

import kanegen as kg
from kanegen.errors import BuildError
from website.gallery import ROOT, SCENES, Scene, simulated

MADE = ROOT / "build" / "live"
"""The folder of the pages."""

GIMBAL_LOCK = "gimbal-lock"

_LOGGER = logging.getLogger(__name__)


def moving_page(scene: Scene) -> str:
    """Return the page of a motion of the gallery."""
    system, _, motion = simulated(scene)
    paths = [scene.trace[0]] if scene.trace else []
    return kg.view(system, motion, paths=paths).html()


def gimbal_lock_page() -> str:
    """Return the page on which C in WebAssembly passes gimbal lock.

    Raises:
        BuildError: If there is no compiler for WebAssembly.
    """
    from benchmarks.gimbal_lock.page import gimbal_lock  # noqa: PLC0415 - of the checkout, not of kanegen

    return gimbal_lock(lambda stage: None).html()


def _make(name: str, page: Callable[[], str], sources: Iterable[Path]) -> None:
    """Write a page unless it is newer than everything that it is made of."""
    file = MADE / f"{name}.html"
    changed = max(source.stat().st_mtime for source in sources)
    if file.exists() and file.stat().st_mtime > changed:
        return
    try:
        text = page()
    except BuildError as error:
        _LOGGER.info("%s.html is left out: %s", name, error)
        return
    file.write_text(text, encoding="utf-8")


def _make_all(app: Sphinx) -> None:
    """Make all pages that are missing or old."""
    if app.config.live_pages:
        MADE.mkdir(parents=True, exist_ok=True)
        scripts = (
            path for path in (ROOT / "templates").rglob("*") if path.suffix in {".js", ".css", ".jinja"}
        )
        programs = [*Path(kg.__file__).parent.rglob("*.py"), *Path(__file__).parent.glob("*.py"), *scripts]
        for scene in SCENES:
            model = ROOT / "models" / f"{scene.model}.toml"
            _make(scene.model, partial(moving_page, scene), [model, *programs])
        _make(
            GIMBAL_LOCK,
            gimbal_lock_page,
            [*(ROOT / "benchmarks" / GIMBAL_LOCK.replace("-", "_")).iterdir(), *programs],
        )


def _link(app: Sphinx, docname: str, source: list[str]) -> None:
    """Link to the pages from the gallery and from the guide to motions in a browser."""
    made = {file.stem for file in MADE.glob("*.html")} if app.config.live_pages else set()
    if docname == "gallery":
        for name in made:
            cost = f"[cost](models/{name}.md)"
            source[0] = source[0].replace(cost, f'{cost}, <a href="live/{name}.html">in 3D</a>')
    if docname == "web" and GIMBAL_LOCK in made:
        link = f'<a href="live/{GIMBAL_LOCK}.html">Open the page.</a>'
        source[0] = source[0].replace("![A T-handle", f"{link}\n\n![A T-handle")


def _copy(app: Sphinx, exception: Exception | None) -> None:
    """Put the pages into the site."""
    if app.config.live_pages and exception is None:
        shutil.copytree(MADE, Path(app.outdir) / "live", dirs_exist_ok=True)


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect the pages with Sphinx."""
    app.add_config_value("live_pages", True, "env", types=bool)
    app.connect("builder-inited", _make_all)
    app.connect("source-read", _link)
    app.connect("build-finished", _copy)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
