"""The literal derivation in SymPy: Eqs. (2)-(45) of the notes, to read and to simplify."""

from kanegen.symbolic.closed.form import ClosedForm
from kanegen.symbolic.equations import Equations, derive
from kanegen.symbolic.literal.dynamics import BodyEquations

__all__ = ["BodyEquations", "ClosedForm", "Equations", "derive"]
