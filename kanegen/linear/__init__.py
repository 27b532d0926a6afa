"""Linear models d/dt {xi} = [A]{xi} + [B]{u} of small deviations from a motion, with names for all signals.

`state_space` holds the matrices, `eigenvalues` solves for their eigenvalues with bounds on the errors,
`modes` says what these mean for a mechanical system, `controllability` what inputs reach and outputs show,
`printing` writes it all, and `linear_model` is the class that users get. Nothing here knows bodies or joints:
equations in SymPy and compiled libraries both make linear models.
"""

from kanegen.linear.controllability import Subspace
from kanegen.linear.linear_model import LinearModel
from kanegen.linear.modes import Mode, Stability

__all__ = ["LinearModel", "Mode", "Stability", "Subspace"]
