"""The equations for readers: as plain text, Markdown, LaTeX or a Python module.

`document` composes the document on a system from `statements`, which print expressions by `printers`;
`formats` writes a document in one format, and `python_module` writes code. `blocks` writes the
equations of a body in 3 x 3 blocks, as the notes print their example, by the symbolic products and sums of
`block_terms`. Only the conversion of finished equations to text belongs here.
"""

from kanegen.symbolic.printing.blocks import Blocks
from kanegen.symbolic.printing.formats import FORMATS, render

__all__ = ["FORMATS", "Blocks", "render"]
