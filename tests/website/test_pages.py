"""The pages in docs/: each can be reached, every link leads somewhere, every function has its place."""

import re
from pathlib import Path
from typing import Any

import pytest
from docutils.core import publish_doctree
from docutils.utils import Reporter
from mdit_py_plugins.anchors.index import slugify
from website.command_line import commands, section
from website.docstrings import restructured
from website.mathml import mathml
from website.tree import INDEX_PAGES, children

import kanegen as kg
from tests.support.paths import ROOT

DOCS = ROOT / "docs"
PAGES = sorted(page for page in DOCS.rglob("*.md") if DOCS / "website" not in page.parents)
DOCUMENTS = [*PAGES, ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"]


def _without_code(text: str) -> str:
    """Return Markdown without its blocks and spans of code."""
    text = re.sub(r"^(```+).*?^\1$", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"`[^`\n]*`", "`code`", re.sub(r"^    .*$", "", text, flags=re.MULTILINE))


def _anchors(page: Path) -> set[str]:
    """Return the anchors that a forge gives to the headings of a page."""
    text = re.sub(r"^(```+).*?^\1$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    titles = re.findall(r"^#+ (.*)$", text, flags=re.MULTILINE)
    return {slugify(title.replace("`", "")) for title in titles}


def test_every_page_is_in_the_tree() -> None:
    reached: set[Path] = set()
    waiting = [DOCS / "index.md"]
    while waiting:
        page = waiting.pop()
        assert page not in reached, f"{page} stands in the tree twice"
        reached.add(page)
        if page.relative_to(DOCS).with_suffix("").as_posix() in INDEX_PAGES:
            below = children(page.read_text(encoding="utf-8"))
            waiting += [(page.parent / f"{name}.md").resolve() for _, name in below]
    outside = [page.relative_to(DOCS).as_posix() for page in PAGES if page not in reached]
    assert not outside, "an index page such as docs/guides.md lists every page"


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_to_files_and_headings(document: Path) -> None:
    text = _without_code(document.read_text(encoding="utf-8"))
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if not target.startswith(("https://", "http://")):
            path, _, anchor = target.partition("#")
            page = (document.parent / path).resolve() if path else document
            assert page.exists(), target
            assert not anchor or anchor in _anchors(page), target


def test_every_public_name_has_its_place_among_the_functions() -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in (DOCS / "api").glob("*.md"))
    described = re.findall(r"^\.\. auto\w+:: kanegen\.(\w+)$", text, flags=re.MULTILINE)
    assert sorted(described) == sorted(set(kg.__all__) - {"__version__"})


@pytest.mark.parametrize("name", sorted(set(kg.__all__) - {"__version__"}))
def test_docstrings_are_restructured_text(name: str) -> None:
    value = getattr(kg, name)
    members = (
        [getattr(value, key) for key in dir(value) if not key.startswith("_")]
        if isinstance(value, type)
        else []
    )
    for docstring in filter(
        None, [one.__doc__ for one in [value, *members] if getattr(one, "__doc__", None)]
    ):
        _require_no_messages(docstring)


def _require_no_messages(docstring: str) -> None:
    """Parse a docstring as the site does, and fail on anything that docutils complains about."""
    lines = restructured(_cleaned(docstring))
    text = "\n".join([".. default-role:: code", "", *lines])
    settings = {"halt_level": Reporter.WARNING_LEVEL, "report_level": Reporter.SEVERE_LEVEL}
    publish_doctree(text, settings_overrides=settings)


def _cleaned(docstring: str) -> list[str]:
    first, _, rest = docstring.expandtabs().partition("\n")
    lines = rest.splitlines()
    margin = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    return [first.strip(), *(line[margin:] for line in lines)]


def test_the_index_of_a_rate_stands_beside_it() -> None:
    printed = mathml(r"\dot{q}_{1} + \sum_{k}^{n} \sin x", as_block=True)
    assert re.search(r"<msub>\s*<mover accent=.true.>\s*<mi>q</mi>\s*<mo[^>]*>˙</mo>", printed)
    assert "<munderover>" in printed  # of the sum


def test_names_of_functions_stand_apart() -> None:
    printed = re.sub(r"\s*\n\s*", "", mathml(r"2 \cos^{2}{x} - \sin{(a + b)}", as_block=True))
    space = r'<mspace width="0.17em" />'
    assert f"<mn>2</mn>{space}<msup><mi>cos</mi><mn>2</mn></msup>{space}<mi>x</mi>" in printed
    assert '<mo>−</mo><mi>sin</mi><mrow><mo stretchy="false">(</mo>' in printed  # noqa: RUF001


def test_what_is_no_markup_stays_as_it_is() -> None:
    lines = restructured(
        ["The error |computed - exact| of `x_`s, times 2*x_.", "", "Returns:", "    (n,), rad: or m.", "",
         "Raises:", "    OptionError: If `x` is", "        missing.", "", "Example:", "    kg.load(path)"]
    )  # fmt: skip
    assert lines[0] == r"The error \|computed - exact\| of `x_`\ s, times 2\*x\_."
    assert ":returns: (n,), rad: or m." in lines
    assert ":raises OptionError: If `x` is missing." in lines
    assert "   kg.load(path)" in lines


@pytest.mark.parametrize(("name", "command"), list(commands()))
def test_a_command_is_described_with_all_its_options(name: str, command: Any) -> None:
    text = section(name, command)
    assert text.startswith(f"## {name}\n\n") and f"$ {name} " in text
    assert all(
        f"`{option}`" in text
        for parameter in command.params
        for option in parameter.opts[-1:]
        if "-" in option
    )
    terms = re.findall(r"^`.*\n: \S", text, flags=re.MULTILINE)
    assert len(terms) == len(command.params)


def test_children_are_the_links_that_begin_items() -> None:
    text = "# A\n\n- [One](one.md): see [two](two.md)\n\n| [Three](b/three.md) | [four](four.md) |\n- [x](https://a.md)\n"
    assert children(text) == [("One", "one"), ("Three", "b/three")]
