"""Motion over time: the equations of a compiled model, integrated.

`simulate` is the entry. `motion` has the right side of the equations, `integration` the steps and solvers,
`trajectory` the result, and `accuracy` its digits and drift. Fixed steps need only NumPy; the adaptive
solvers are those of SciPy, from the extra `study`.
"""

from kanegen.simulation.accuracy import Drift, mescd
from kanegen.simulation.simulate import METHODS, simulate
from kanegen.simulation.trajectory import Trajectory

__all__ = ["METHODS", "Drift", "Trajectory", "mescd", "simulate"]
