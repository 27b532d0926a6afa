"""Motion over time: a compiled model integrated from Python.

Fixed steps need nothing but NumPy; the adaptive methods are SciPy's, from the extra `study`. Nothing else
imports this subpackage.
"""

from kanegen.library.simulation.accuracy import Drift, mescd
from kanegen.library.simulation.simulate import METHODS, simulate
from kanegen.library.simulation.trajectory import Trajectory

__all__ = ["METHODS", "Drift", "Trajectory", "mescd", "simulate"]
