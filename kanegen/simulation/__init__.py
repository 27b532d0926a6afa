"""Motion over time: the equations of a compiled model, integrated.

`simulate` is the entry; `arguments` checks what it is given, `libraries` builds what a system needs, and
`choice` takes the method by the error that is asked for. `motion` is the right side of the equations, and
`inputs` what acts from outside: functions, expressions (`signals`) and tables (`input_tables`). `methods`
names the methods; `integration` has their steps, and `stretches` the states that they make one after the
other. `solver` puts these together; `running` keeps the states and watches for `events`. `trajectory` is the
result, with names and units (`elements`), as tables and files (`tables`), as a picture, and with its digits
(`accuracy`); the `time_history` in it has outputs over the time, energies and momentum, whose `conservation`
tells about the errors.

Fixed steps need only NumPy. The adaptive solvers are those of SciPy, from the extra `study`; tables need the
extra `results`, pictures the extra `plot`.
"""

from kanegen.simulation.accuracy import Drift, mescd
from kanegen.simulation.events import Event, Occurrence
from kanegen.simulation.libraries import library_for
from kanegen.simulation.methods import METHODS
from kanegen.simulation.simulate import simulate
from kanegen.simulation.trajectory import Trajectory

__all__ = ["METHODS", "Drift", "Event", "Occurrence", "Trajectory", "library_for", "mescd", "simulate"]
