"""From programs to code: the seam for target languages, and the target C99.

`render` turns the programs of a module into a `Source`, the text of every file of code. What may enter here
are expressions, statements, declarations, headers and whatever else code consists of; a file that stands
beside the code for the sake of one kind of user is an artifact and belongs to `kanegen.artifacts`.
"""

from kanegen.c.description import ModelDescription, description
from kanegen.c.render import render
from kanegen.c.source import Source

__all__ = ["ModelDescription", "Source", "description", "render"]
