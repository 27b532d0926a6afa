"""The literal derivation in SymPy: Eqs. (2)-(45) of the notes, to read and to simplify."""

from kanegen.symbolic.closed.form import ClosedForm
from kanegen.symbolic.dynamics import BodyEquations
from kanegen.symbolic.equations import Equations, derive

__all__ = ["BodyEquations", "ClosedForm", "Equations", "derive"]
