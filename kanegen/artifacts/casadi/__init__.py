"""The artifact "casadi": the functions of a source as external functions of CasADi.

`sources` says which functions of C give results and derivatives, `functions` makes functions of CasADi of
them, with the patterns of `pattern`, and `printing` prints these as C in the interface of `casadi.external`.
"""

from kanegen.artifacts.casadi.functions import casadi_functions, symbol
from kanegen.artifacts.casadi.matrix import CasadiFunction, Matrix
from kanegen.artifacts.casadi.printing import (
    casadi,
    derivatives,
    file_name,
    other_numbers,
    refusal,
    usual_outputs,
)
from kanegen.artifacts.casadi.sources import ODE

__all__ = [
    "ODE",
    "CasadiFunction",
    "Matrix",
    "casadi",
    "casadi_functions",
    "derivatives",
    "file_name",
    "other_numbers",
    "refusal",
    "symbol",
    "usual_outputs",
]
