"""From programs to C: expressions, function bodies, declarations, and the files around them."""

from kanegen.c.files import render
from kanegen.c.interface import ModelFacts
from kanegen.c.source import Source

__all__ = ["ModelFacts", "Source", "render"]
