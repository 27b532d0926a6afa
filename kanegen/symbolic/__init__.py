"""The equations of motion in SymPy.

`literal` derives Eqs. (2)-(45) of the notes matrix by matrix, for reading; `closed` simplifies the result of
a small tree; `printing` writes it as text, Markdown, LaTeX or Python. `Equations` is what `derive` returns.

Four modules are shared with the recursive derivation in `kanegen.recursion`: `symbols` and `state_symbols`
make all SymPy symbols, `definitions` names intermediate results, and `expressions` translates the expressions
of force elements. These hold notation and no mechanics, so the two derivations stay independent. Nothing else
may be shared: mechanics belongs to `literal`, and other modules here only read its matrices.
"""

from kanegen.symbolic.closed.form import ClosedForm
from kanegen.symbolic.equations import Equations, derive
from kanegen.symbolic.literal.dynamics import BodyEquations

__all__ = ["BodyEquations", "ClosedForm", "Equations", "derive"]
