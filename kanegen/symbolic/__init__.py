"""The literal derivation in SymPy: Eqs. (2)-(45) of the notes, to read and to simplify."""

from kanegen.symbolic.blocks import Blocks
from kanegen.symbolic.closed_form import ClosedForm
from kanegen.symbolic.dynamics import BodyEquations
from kanegen.symbolic.equations import Equations, derive
from kanegen.symbolic.formats import render

__all__ = ["Blocks", "BodyEquations", "ClosedForm", "Equations", "derive", "render"]
