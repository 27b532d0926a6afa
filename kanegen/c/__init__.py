"""From programs to C: expressions, function bodies, declarations, and the files around them."""

from kanegen.c.interface import ModelFacts
from kanegen.c.render import render
from kanegen.c.source import Source

__all__ = ["ModelFacts", "Source", "render"]
