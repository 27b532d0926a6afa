"""The equations for people: in blocks as the notes print them, as text, Markdown, LaTeX or Python."""

from kanegen.symbolic.printing.blocks import Blocks
from kanegen.symbolic.printing.formats import FORMATS, render

__all__ = ["FORMATS", "Blocks", "render"]
