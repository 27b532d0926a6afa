"""States of rest and steady motions: {x} for which given speeds, by default zero, stay as they are.

`balance` has the forces that must vanish and their derivatives, from C; `search` finds zeros from many starts
at once; `families` recognises equal states and continuous families; `stability` judges what is found;
`equilibrium` has the results.
"""

from kanegen.library.equilibria.equilibrium import Equilibria, Equilibrium
from kanegen.library.equilibria.finding import OUTPUTS, find_equilibria

__all__ = ["OUTPUTS", "Equilibria", "Equilibrium", "find_equilibria"]
