"""The tree of pages, made from lists of links.

An index page of the site is plain Markdown: a list or a table whose items each begin with a link to a page.
Those pages, in their order and under the texts of the links, are its children.
"""

import re

from sphinx.application import Sphinx

INDEX_PAGES = (
    "index",
    "tutorials/index",
    "guides",
    "embedding",
    "trust",
    "cost",
    "models/README",
    "reference",
    "api/index",
    "inside",
)
"""The pages whose items are their children."""

_ITEM = re.compile(r"^(?:- |\| )\[(?P<text>[^\]]+)\]\((?P<page>[^):#]+)\.md\)", re.MULTILINE)


def children(markdown: str) -> list[tuple[str, str]]:
    """Return the texts and the names of the pages to which the items of an index page link."""
    return [(match["text"], match["page"]) for match in _ITEM.finditer(markdown)]


def _add_children(app: Sphinx, docname: str, source: list[str]) -> None:
    """Append the tree of its children to an index page."""
    if docname in INDEX_PAGES:
        entries = "\n".join(f"{text} <{page}>" for text, page in children(source[0]))
        source[0] += f"\n\n```{{toctree}}\n:hidden:\n\n{entries}\n```\n"


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect the tree with Sphinx."""
    app.connect("source-read", _add_children)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
