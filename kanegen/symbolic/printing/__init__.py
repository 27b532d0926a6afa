"""The equations for readers: as plain text, Markdown, LaTeX or a Python module.

`document` composes the document on a system from `statements`, which print expressions by `printers`;
`formats` writes a document in one format; `python_module` and `python_blocks` write code. `blocks` writes the
equations of a body in 3 x 3 blocks, as the notes print their example, by the symbolic products and sums of
`block_terms`, and `linear_model` a linear model. Only the conversion of finished equations to text belongs
here.
"""

from kanegen.symbolic.printing.blocks import Blocks
from kanegen.symbolic.printing.formats import FORMATS, render
from kanegen.symbolic.printing.linear_model import LINEAR_FORMATS, render_linear_model

__all__ = ["FORMATS", "LINEAR_FORMATS", "Blocks", "render", "render_linear_model"]
