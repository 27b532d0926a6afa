"""Formulas as MathML, which browsers print themselves: no script, no font and no network is needed."""

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

_LOGGER = logging.getLogger(__name__)


def _print(translator: HTML5Translator, node: nodes.Element, *, as_block: bool) -> None:
    """Write a formula; one that has no MathML stays TeX, with a warning."""
    text = node.astext()
    try:
        body = tex2mathml(text, as_block=as_block)
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
