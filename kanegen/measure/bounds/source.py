"""Bounds of a generated source: its programs, precisions, sines and outputs."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from kanegen.c.formats import Formats, formats
from kanegen.c.sincos import sincos_named
from kanegen.c.source import Source
from kanegen.errors import OptionError, quoted
from kanegen.measure.bounds.domain import InputBox
from kanegen.measure.bounds.outputs import Bounder, OutputBound
from kanegen.measure.bounds.report import Bounds
from kanegen.measure.bounds.rounding import Roundings, Sines
from kanegen.measure.bounds.sines import LibmSines, kanegen_sines
from kanegen.model.system import System
from kanegen.options import Variant
from kanegen.program.ir import Array
from kanegen.program.precision import DOUBLE_DOUBLE, Precision, precision_named
from kanegen.recursion.constants import distance_from_rotation
from kanegen.recursion.outputs import ERROR_BOUNDS, OUTPUTS


def bound_source(source: Source, box: InputBox) -> Bounds:
    """Return proven bounds of all outputs of a source over a box.

    Raises:
        OptionError: If the source does not carry its programs, or its variant has no bounds.
    """
    if source.module is None:
        raise OptionError("bound: this source does not carry its programs. Generate it anew.")
    _require_strict(source.variant)
    arrays = formats(source.variant)
    sines = {
        precision: _sines(source.variant, precision) for precision in {arrays.arithmetic, arrays.preparing}
    }
    bounder = Bounder(source.module, arrays, Roundings(sines), box.intervals(arrays))
    filled = {name: OUTPUTS[name].array(box.system) for name in source.outputs}
    found: dict[str, OutputBound] = {
        name: bounder.bound(array.name) if name not in ERROR_BOUNDS else _a_bound_itself(array)
        for name, array in filled.items()
    }
    return Bounds(
        model=source.model.shown,
        precision=source.precision,
        box=box,
        outputs={name: one.errors for name, one in found.items()},
        magnitudes={name: one.magnitudes for name, one in found.items()},
        unbounded={name: _with_names(one.reason, box.system) for name, one in found.items() if one.reason},
        assumptions=tuple(_assumptions(source.variant, arrays, box.system)),
        units={name: array.unit for name, array in filled.items()},
    )


def _with_names(reason: str, system: System) -> str:
    """Return a reason in which freedoms and coordinates have their names instead of their places."""
    named = re.sub(
        r"the freedom at place (\d+)", lambda m: f"freedom {system.freedom_names[int(m[1])]!r}", reason
    )
    named = re.sub(r"\bx\[(\d+)\]", lambda m: f"{m[0]} ({system.coordinate_names[int(m[1])]!r})", named)
    if short := re.match(r"the divisor eq_(\d+) ", named):
        body = quoted(system.bodies[int(short[1]) - 1].name)
        return (
            f"the quaternion of body {body} may have length 0 in the box; ranges without it help, such as "
            "x.quaternions = [0.5, 1.0], or exclude.quaternions = 0.5, which keeps all unit quaternions"
        )
    return named


def _a_bound_itself(array: Array) -> OutputBound:
    """Return the answer for an output that bounds errors, and so has no exact value to be compared with."""
    nothing = np.full(array.shape, np.inf)
    return OutputBound(nothing, nothing, "it is a bound itself, which includes its own rounding")


def _require_strict(variant: Variant) -> None:
    """Make sure that bounds are proven for a variant.

    Raises:
        OptionError: If its semantics or its precision have none.
    """
    if not variant.is_strict:
        raise OptionError(
            f"bound: there are no bounds for semantics {', '.join(variant.semantics)}. Take strict semantics."
        )
    if variant.precision == DOUBLE_DOUBLE.name:
        raise OptionError("bound: there are no bounds for precision 'double-double'. Take another precision.")


def _sines(variant: Variant, precision: Precision) -> Sines:
    """Return the errors of sine and cosine of a variant in one of its precisions."""
    sincos = sincos_named(variant.sincos, precision)
    return LibmSines(precision) if sincos is None else kanegen_sines(sincos)


def _assumptions(variant: Variant, arrays: Formats, system: System) -> Iterator[str]:
    """Yield what the bounds of a variant take for granted."""
    yield (
        "operations are rounded to nearest as IEEE 754 says, in the order of the program, as kanegen's "
        "default flags keep it."
    )
    yield (
        "exact is the function of the very numbers of the model and of the inputs; inputs with a range are "
        f"numbers of {arrays.storage.label} precision in it, and inputs with one value, such as parameters, "
        "have this value, whose rounding to their precision counts."
    )
    if sincos_named(variant.sincos, arrays.arithmetic) is None:
        yield "sine and cosine of the C library err by at most one unit in the last place."
    if not precision_named(variant.precision).constants.are_rotations_exact:
        distances = {body.name: distance_from_rotation(body.joint) for body in system.bodies}
        inexact = [name for name, distance in distances.items() if distance]
        if inexact:
            yield (
                f"the joint orientations of {', '.join(map(repr, inexact))} count as they are written; they "
                f"differ from rotations by {max(distances.values()):.1e}."
            )
        if any(
            isinstance(angle, float) and angle for body in system.bodies for angle in body.joint.locked[:3]
        ):
            yield "sines and cosines of locked angles count as the doubles nearest to them."
