"""Motion over time: a library integrated from Python.

`simulate` is the entry. `motion` has the right side of the equations, `integration` the steps and solvers,
`trajectory` the result, and `accuracy` its digits and drift. Fixed steps need only NumPy; the adaptive
solvers are those of SciPy, from the extra `study`.
"""

from kanegen.library.simulation.accuracy import Drift, mescd
from kanegen.library.simulation.simulate import METHODS, simulate
from kanegen.library.simulation.trajectory import Trajectory

__all__ = ["METHODS", "Drift", "Trajectory", "mescd", "simulate"]
