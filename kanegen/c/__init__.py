"""From programs to code: the interface of target languages, and the target C99.

`render` turns the programs of a module into a `Source`, the text of every file of code. Expressions,
statements, declarations and headers belong here; an optional file for one kind of user is an artifact and
belongs to `kanegen.artifacts`.
"""

from kanegen.c.description import ModelDescription, description
from kanegen.c.render import render
from kanegen.c.source import Source

__all__ = ["ModelDescription", "Source", "description", "render"]
