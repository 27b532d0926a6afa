"""Formulas as MathML, which browsers print themselves: no script, no font and no network is needed."""

from xml.etree import ElementTree

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

_LOGGER = logging.getLogger(__name__)

_NAMESPACE = "http://www.w3.org/1998/Math/MathML"


_ROWS = {"math", "mrow", "mtd", "mstyle"}
"""Elements whose parts stand in a row."""


def mathml(text: str, *, as_block: bool) -> str:
    r"""Return a formula of TeX as MathML.

    The converter sets the index of a letter with an accent, as in \dot{q}_1, under the letter, as below a
    sum; here it stands beside the letter.

    Raises:
        MathError: If there is no MathML for something in it.
    """
    ElementTree.register_namespace("", _NAMESPACE)
    printed = tex2mathml(text, as_block=as_block).replace("<mo>&ApplyFunction;</mo>", "")
    root = ElementTree.fromstring(printed)
    for element in root.iter(f"{{{_NAMESPACE}}}munderover"):
        letter, index, accent = element
        if letter.tag != f"{{{_NAMESPACE}}}mo":
            element.tag = f"{{{_NAMESPACE}}}msub"
            accented = ElementTree.Element(f"{{{_NAMESPACE}}}mover", accent="true")
            accented.extend([letter, accent])
            element[:] = [accented, index]
    for element in list(root.iter()):
        if element.tag.rpartition("}")[2] in _ROWS:
            element[:] = _spaced(list(element))
    return ElementTree.tostring(root, encoding="unicode")


def _spaced(children: list[ElementTree.Element]) -> list[ElementTree.Element]:
    """Return the parts of a row with the thin spaces that TeX puts around the name of a function."""
    if not any(_is_function(child) for child in children):
        return children
    found: list[ElementTree.Element] = []
    for child, following in zip(children, [*children[1:], None], strict=True):
        if _is_function(child) and found and not found[-1].tag.endswith("}mo"):
            found.append(_thin_space())
        found.append(child)
        if _is_function(child) and following is not None and not _text(following).startswith("("):
            found.append(_thin_space())
    return found


def _is_function(element: ElementTree.Element) -> bool:
    """Say whether an element is the name of a function, such as cos, or a power of it."""
    kind = element.tag.rpartition("}")[2]
    if kind in {"msup", "msub"}:
        return _is_function(element[0])
    return kind == "mi" and len(element.text or "") > 1 and (element.text or "").isascii()


def _text(element: ElementTree.Element) -> str:
    return "".join(element.itertext()).strip()


def _thin_space() -> ElementTree.Element:
    return ElementTree.Element(f"{{{_NAMESPACE}}}mspace", width="0.17em")


def _print(translator: HTML5Translator, node: nodes.Element, *, as_block: bool) -> None:
    """Write a formula; one that has no MathML stays TeX, with a warning."""
    text = node.astext()
    try:
        body = mathml(text, as_block=as_block)
    except MathError as error:
        _LOGGER.warning("no MathML: %s", error, location=node, type="mathml")
        body = f"<code>{translator.encode(text)}</code>"
    translator.body.append(f'<div class="math">{body}</div>' if as_block else body)
    raise nodes.SkipNode


def _inline(translator: HTML5Translator, node: nodes.math) -> None:
    _print(translator, node, as_block=False)


def _block(translator: HTML5Translator, node: nodes.math_block) -> None:
    _print(translator, node, as_block=True)


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect the renderer with Sphinx as `html_math_renderer = "mathml"`."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
