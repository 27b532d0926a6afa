"""The arithmetics that code can be generated for."""

from kanegen.precision.kinds import Precision, split
from kanegen.precision.known import (
    DOUBLE,
    DOUBLE_DOUBLE,
    FLOAT,
    LONG_DOUBLE,
    PRECISIONS,
    named,
    storage,
)

__all__ = [
    "DOUBLE",
    "DOUBLE_DOUBLE",
    "FLOAT",
    "LONG_DOUBLE",
    "PRECISIONS",
    "Precision",
    "named",
    "split",
    "storage",
]
