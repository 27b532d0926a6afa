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


def mathml(text: str, *, as_block: bool) -> str:
    r"""Return a formula of TeX as MathML.

    The converter sets the index of a letter with an accent, as in \dot{q}_1, under the letter, as below a
    sum; here it stands beside the letter.

    Raises:
        MathError: If there is no MathML for something in it.
    """
    ElementTree.register_namespace("", _NAMESPACE)
    printed = tex2mathml(text, as_block=as_block).replace("&ApplyFunction;", "\u2061")
    root = ElementTree.fromstring(printed)
    for element in root.iter(f"{{{_NAMESPACE}}}munderover"):
        letter, index, accent = element
        if letter.tag != f"{{{_NAMESPACE}}}mo":
            element.tag = f"{{{_NAMESPACE}}}msub"
            accented = ElementTree.Element(f"{{{_NAMESPACE}}}mover", accent="true")
            accented.extend([letter, accent])
            element[:] = [accented, index]
    return ElementTree.tostring(root, encoding="unicode")


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
