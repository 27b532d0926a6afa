"""The site as `make docs` makes it: no warning, no dead link, nothing from a network."""

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest
from website.gallery import SCENES
from website.live import moving_page

from tests.support.paths import ROOT

LOADED = {"script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src"}
"""The attribute of an element by which a browser loads something."""


class _Page(HTMLParser):
    """The anchors, the links and the loaded files of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: set[str] = set()
        self.loaded: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {key: value or "" for key, value in attrs}
        self.anchors.add(values.get("id", ""))
        if tag == "a" and "href" in values:
            self.links.add(values["href"])
        if LOADED.get(tag, "") in values and values.get("rel") not in {"index", "search", "next", "prev"}:
            self.loaded.add(values[LOADED[tag]])


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, _Page]:
    """The pages of the site by their paths, with notebooks that have not run and no live pages."""
    folder = tmp_path_factory.mktemp("site")
    options = ["--nitpicky", "--fail-on-warning", "--keep-going", "--quiet"]
    options += ["-D", "nb_execution_mode=off", "-D", "live_pages=0"]
    command = [sys.executable, "-m", "sphinx", "-c", "docs/website", "docs", str(folder), *options]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return {page: _Page(page.read_text(encoding="utf-8")) for page in folder.rglob("*.html")}


@pytest.mark.slow
def test_the_site_loads_nothing_from_elsewhere(site: dict[Path, _Page]) -> None:
    for path, page in site.items():
        for target in page.loaded:
            file = path.parent / target.partition("?")[0].partition("#")[0]
            assert target.startswith("data:") or file.exists(), f"{path.name} loads {target}"


@pytest.mark.slow
def test_every_link_of_the_site_leads_to_a_place_in_it(site: dict[Path, _Page]) -> None:
    for path, page in site.items():
        for target in page.links:
            name, _, anchor = target.partition("#")
            if not name.startswith(("https://", "http://")):
                aim = (path.parent / name).resolve() if name else path
                assert aim.exists(), f"{path.name} links to {target}"
                assert not anchor or aim not in site or anchor in site[aim].anchors, f"{path.name}: {target}"


@pytest.mark.slow
def test_a_live_page_has_the_motion_of_the_gallery() -> None:
    scene = next(scene for scene in SCENES if scene.model == "quarter_car")
    text = moving_page(scene)
    assert '"name":"quarter_car"' in text and '"motion":{' in text
    assert "https://" not in re.sub(r"<script.*?</script>", "", text, flags=re.DOTALL)
