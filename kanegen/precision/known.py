"""The precisions that there are, by name."""

from __future__ import annotations

import numpy as np

from kanegen.choices import require_one
from kanegen.errors import OptionError
from kanegen.precision.kinds import LongDouble, Pairs, Precision

_DOUBLE = np.dtype(np.float64)

DOUBLE = Precision("double", "double", "double", "", _DOUBLE, 8, 53, 17)
FLOAT = Precision(
    "float", "single", "float", "f", np.dtype(np.float32), 4, 24, 9, ("float", "double", "long double")
)
LONG_DOUBLE = LongDouble(
    name="long double",
    words="long double",
    type="long double",
    suffix="l",
    dtype=np.dtype(np.longdouble),
    bytes=16,
    digits=64,
    decimals=36,
    storages=("long double", "double", "float"),
    needs=frozenset({"subnormal numbers"}),  # which no mode of its registers gives up
)
DOUBLE_DOUBLE = Pairs(
    name="double-double",
    words="double-double",
    type="kanegen_pair",
    suffix="",
    dtype=_DOUBLE,
    bytes=16,
    digits=106,
    decimals=33,
    storages=("double", "double-double"),
    needs=frozenset(
        {
            "subnormal numbers",
            "products rounded by themselves",
            "order of sums",
            "rounding of quotients",
            "rounding of roots",
            "no excess precision",
        }
    ),
)

PRECISIONS = {precision.name: precision for precision in (DOUBLE, FLOAT, LONG_DOUBLE, DOUBLE_DOUBLE)}
"""What can be asked for."""


def named(name: str) -> Precision:
    """The precision that is called `name`.

    Raises:
        OptionError: If there is none.
    """
    require_one("precision", name, PRECISIONS)
    return PRECISIONS[name]


def storage(precision: str, name: str = "") -> Precision:
    """The precision of arrays: `name`, or the own one of `precision` where there is none.

    Raises:
        OptionError: If there is no such precision, or it does not go with `precision`.
    """
    own = named(precision).storages
    found = named(name or own[0])
    if found.name not in own:
        raise OptionError(
            f"storage {name!r} does not go with precision {precision!r}, which takes {', '.join(own)}."
        )
    return found
