"""Pages of the repository's files and folders to which the documents link, such as models and generated C.

On a forge such a link leads to the file. The site has a page for it, with highlighted text, so that it needs
nothing but itself. A page of HTML, such as a picture of a mechanism, is copied as it is.
"""

import shutil
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Any

from docutils import nodes
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import get_lexer_for_filename
from pygments.util import ClassNotFound
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment

ROOT = Path(__file__).parents[2]
"""The folder of the repository."""

LONGEST = 200_000
"""Size in bytes beyond which a file is for loading down, not for reading."""

_PAGES = "files"


def _page_of(path: Path) -> str | None:
    """Return the name of the page of a file or folder, or None if it gets none."""
    if not path.exists() or not path.is_relative_to(ROOT):
        return None
    if path.suffix == ".html":
        return f"{_PAGES}/{path.relative_to(ROOT).with_suffix('').as_posix()}"
    if path.is_file() and (path.stat().st_size > LONGEST or path.suffix in {".svg", ".png", ".json"}):
        return None
    return f"{_PAGES}/{path.relative_to(ROOT).as_posix()}"


def _links(app: Sphinx) -> dict[str, set[str]]:
    """Return the paths that each document links to."""
    links: dict[str, set[str]] = app.env.__dict__.setdefault("repository_links", {})
    return links


def _link_files(app: Sphinx, doctree: nodes.document) -> None:
    """Let links to files and folders of the repository lead to their pages."""
    docname = app.env.docname
    for node in list(
        doctree.findall(lambda node: isinstance(node, addnodes.download_reference | addnodes.pending_xref))
    ):
        path = Path(app.env.relfn2path(node["reftarget"], docname)[1]).resolve()
        page = _page_of(path) if node.get("refdomain") is None else None
        if page is not None:
            target = app.builder.get_relative_uri(docname, page)
            reference = nodes.reference("", "", refuri=target, internal=True)
            reference += node.children
            node.replace_self(reference)
            _links(app).setdefault(docname, set()).add(str(path))


def _forget(app: Sphinx, env: BuildEnvironment, docname: str) -> None:
    """Forget the links of a document that is read again."""
    _links(app).pop(docname, None)


def _file_page(path: Path) -> str:
    """Return the text of a file, highlighted."""
    text = path.read_text(encoding="utf-8")
    try:
        lexer = get_lexer_for_filename(path.name)
    except ClassNotFound:
        return f'<div class="highlight"><pre>{escape(text)}</pre></div>'
    page: str = highlight(text, lexer, HtmlFormatter(linenos=False))
    return page


def _folder_page(path: Path) -> str:
    """Return the files of a folder and of its folders, as links."""
    files = sorted(file for file in path.rglob("*") if file.is_file() and _page_of(file))
    items = (file.relative_to(path.parent).as_posix() for file in files)
    return "<ul>" + "".join(f'<li><a href="{item}.html">{item}</a></li>' for item in items) + "</ul>"


def _pages(app: Sphinx) -> Iterator[tuple[str, dict[str, Any], str]]:
    """Yield the pages of all files and folders that documents link to."""
    paths = {Path(path) for linked in _links(app).values() for path in linked}
    folders = {path for path in paths if path.is_dir()}
    files = {file for folder in folders for file in folder.rglob("*") if file.is_file() and _page_of(file)}
    for path in sorted(path for path in paths | files if path.suffix != ".html"):
        body = _folder_page(path) if path.is_dir() else _file_page(path)
        name = path.relative_to(ROOT).as_posix()
        context = {"title": name, "body": f"<article><h1>{escape(name)}</h1>{body}</article>"}
        yield f"{_PAGES}/{name}", context, "page.html"


def _copy_pages(app: Sphinx, exception: Exception | None) -> None:
    """Copy the pages of HTML to which documents link."""
    paths = {Path(path) for linked in _links(app).values() for path in linked}
    for path in () if exception else sorted(paths):
        if path.suffix == ".html":
            copy = Path(app.outdir) / _PAGES / path.relative_to(ROOT)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, copy)


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect the pages with Sphinx."""
    app.connect("doctree-read", _link_files, priority=400)  # before files for loading down are collected
    app.connect("env-purge-doc", _forget)
    app.connect("html-collect-pages", _pages)
    app.connect("build-finished", _copy_pages)
    return {"parallel_read_safe": False, "parallel_write_safe": True}
