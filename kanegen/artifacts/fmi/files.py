"""The artifacts "fmi2" and "fmi3": the description and the sources of an FMU.

An FMU (Functional Mock-up Unit, https://fmi-standard.org) is a zip file with a description in XML, C and
compiled C. `kanegen.products` compiles the files that are made here and zips all. Model exchange gives the
derivatives of the states {x}, {y}; co-simulation follows them by the steps of the generated C.
"""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

from kanegen import __version__
from kanegen.artifacts.fmi.calls import (
    LOADS,
    OF_LOADS,
    Differentiated,
    calls,
    differentiated,
    rollout_arguments,
)
from kanegen.artifacts.fmi.description import Description, in_lines
from kanegen.artifacts.fmi.layout import USUAL, Layout
from kanegen.artifacts.fmi.names import dotted
from kanegen.artifacts.fmi.structure import Structure
from kanegen.artifacts.fmi.variables import Variable
from kanegen.c.formats import formats
from kanegen.c.interface import PREPARE
from kanegen.c.source import Source
from kanegen.c.templates import fill, raw
from kanegen.model.system import System
from kanegen.program.ir import PREPARED
from kanegen.recursion.outputs import RATES

HEADERS = {
    2: ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    3: ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}
"""Headers of the standard, by its version, as the Modelica Association publishes them."""

_INCLUDE = re.compile(r'^#(?:include|define KANEGEN_VERSION_FILE) "(.+)"$', re.MULTILINE)
"""A line by which a file includes another one, itself or from the header of versions."""

_OTHER_TYPES = "Float32 Int8 UInt8 Int16 UInt16 Int32 UInt32 Int64 UInt64 Boolean String".split()
"""Types of FMI 3.0 that no variable has."""


def needed_outputs(system: System) -> tuple[str, ...]:
    """Return the outputs without which there is no FMU of a system: rates of the state, and steps."""
    return (*(RATES[:1] if system.speeds_are_rates else RATES), USUAL)


def usual_outputs(system: System) -> tuple[str, ...]:
    """Return the outputs that an FMU has besides where the user names none: derivatives, energies, points."""
    points = ("point_positions", "point_velocities") if system.points else ()
    rates = RATES[:1] if system.speeds_are_rates else RATES
    energies = ("kinetic_energy", "potential_energy")
    return (*energies, *points, *(f"{name}_derivatives" for name in (*rates, *energies, *points)))


def refusal(source: Source) -> str:
    """Return why `source` cannot become an FMU, "" if it can."""
    found = formats(source.variant)
    types = {found.storage.c_type, found.parameters.c_type if source.model.parameters else "double"}
    if types != {"double"}:
        return (
            f"the real numbers of FMI are doubles, and states and parameters are {source.storage}. Take "
            "precision double."
        )
    if source.model.contacts:
        return (
            "the system has contacts that hold, but accelerations of an FMU are those without. Leave them "
            "out by System.with_contacts([])."
        )
    if source.system is None or source.render_input is None:
        return "this source does not carry its system. Generate it anew with kg.generate."
    return ""


def fmi2(source: Source) -> dict[str, str]:
    """Return description and sources of an FMU for FMI 2.0, by their paths below `fmi2/`."""
    return {f"fmi2/{path}": text for path, text in files(source, 2).items()}


def fmi3(source: Source) -> dict[str, str]:
    """Return description and sources of an FMU for FMI 3.0, by their paths below `fmi3/`."""
    return {f"fmi3/{path}": text for path, text in files(source, 3).items()}


def files(source: Source, version: int) -> dict[str, str]:
    """Return description and sources of an FMU by their paths in its zip file.

    Args:
        source: Generated C, for which `refusal` is empty.
        version: Version of FMI, 2 or 3.
    """
    assert source.system is not None
    assert source.module is not None
    layout = Layout(source, source.system)
    structure = Structure(layout, source.module)
    slopes = differentiated(layout, {name: structure.read(name) for name in layout.computed})
    own = _model_files(source)
    token = _token(layout, version, own)
    description = Description(layout, structure, slopes, token, version)
    name, api = source.model.name, f"fmi{version}.c"
    compiled = [api, f"{name}_fmu.c", *(file for file in own if file.endswith(".c"))]
    found = {
        "modelDescription.xml": fill(
            f"artifacts/fmi/fmi{version}.xml", sources=compiled, **description.context()
        )
    }
    if version == 3:
        found["sources/buildDescription.xml"] = fill(
            "artifacts/fmi/buildDescription.xml", model=source.model, sources=compiled
        )
    context = _context(layout, description, slopes)
    texts = {
        api: fill(f"artifacts/fmi/{api}", **context),
        f"{name}_fmu.h": fill("artifacts/fmi/fmu.h", **context),
        f"{name}_fmu.c": fill("artifacts/fmi/fmu.c", **context),
        **own,
        **{header: raw(f"artifacts/fmi/{header}") for header in HEADERS[version]},
    }
    return found | {f"sources/{file}": text for file, text in texts.items()}


def _model_files(source: Source) -> dict[str, str]:
    """Return the C of the functions for one state, and every header that it includes."""
    found: dict[str, str] = {}
    waiting = [f"{source.model.name}.c"]
    while waiting:
        file = waiting.pop()
        found[file] = source.code[file]
        waiting += [name for name in _INCLUDE.findall(found[file]) if name not in found]
    return found


def _token(layout: Layout, version: int, own: Mapping[str, str]) -> str:
    """Return the text by which description and code are known to belong together: a digest of both."""
    parts = (
        __version__,
        str(version),
        repr(layout.variables),
        *(part for one in own.items() for part in one),
    )
    digest = hashlib.sha256("\0".join(parts).encode()).hexdigest()
    lengths = (0, 8, 12, 16, 20, 32)
    return f"{{{'-'.join(digest[a:b] for a, b in pairwise(lengths))}}}"


def _context(layout: Layout, description: Description, slopes: Sequence[Differentiated]) -> dict[str, Any]:
    """Return the variables of the templates of C."""
    model, made = layout.source.model, calls(layout)
    prepare = layout.functions[PREPARE].outputs[0].size if layout.has_prepare else 0
    sizes = {one.first: one.size for one in description.variables}
    rows = model.rows if any(call.row_quantity for call in made) else ()
    return {
        "model": model,
        "prefix": model.prefix,
        "may_not_converge": layout.source.may_not_converge,
        "token": description.token,
        "is_fmi3": description.version == 3,
        "other_types": _OTHER_TYPES,
        "coordinates": layout.inputs["x"].array.size,
        "speeds": layout.inputs["y"].array.size,
        "states": layout.inputs["x"].array.size + layout.inputs["y"].array.size,
        "settable": layout.settable,
        "size": layout.size,
        "slopes": sum(one.function.outputs[0].size for one in layout.slopes.values()),
        "places": [(name, block.first) for name, block in layout.blocks.items()],
        "sizes": in_lines(sizes.get(place, 0) for place in range(layout.size)),
        "numbers": list(_numbers(layout)),
        "calls": made,
        "cases": [(number, call.text) for number, call in enumerate(made) if call.text],
        "prepare_call": len(made) - 2,
        "step_call": len(made) - 1,
        "prepared": prepare,
        "prepared_type": formats(layout.source.variant).of(PREPARED).c_type,
        "reads_prepared": _flags(call.reads_prepared for call in made),
        "reads_acceleration": _flags(call.reads_acceleration for call in made)
        if any(call.reads_acceleration for call in made)
        else "",
        "rates_are_speeds": not made[0].text,
        "freedoms": [dotted(name) for name in model.freedom_names],
        "rows": [dotted(name) for name in rows],
        "differentiated": slopes,
        "computed_names": list(layout.computed),
        "longest": max(block.array.size for block in layout.computed.values()),
        "loads": _loads(layout, slopes),
        "prescribed": len(model.prescribed),
        "step": f"{model.name}_{layout.rollout.name}({', '.join(rollout_arguments(layout))})",
    }


def _flags(values: Iterable[bool]) -> str:
    """Return truth values as numbers with commas between them."""
    return ", ".join(str(int(value)) for value in values)


def _loads(layout: Layout, slopes: Sequence[Differentiated]) -> tuple[int, int] | None:
    """Return the place of the first load and the number of loads, None where no derivative is by loads."""
    if not any(part.column == OF_LOADS for one in slopes for part in one.columns):
        return None
    places = [layout.inputs[name].places for name in LOADS if name in layout.inputs]
    return places[0].start, places[-1].stop - places[0].start


def _numbers(layout: Layout) -> Iterator[Mapping[str, str]]:
    """Yield name, kind, first value and range of each number that is set from outside, as text of C."""
    elements = {one.first: one for variable in layout.variables for one in variable.elements()}
    for place in range(layout.settable):
        one = elements.get(place)
        kind = "NO_VARIABLE" if one is None else _kind(one)
        yield {
            "name": "" if one is None else one.name,
            "kind": kind,
            "start": repr(float(one.start or 0.0)) if one else "0.0",
            "least": _c_number(one.minimum) if one else "0.0",
            "largest": _c_number(one.maximum) if one else "0.0",
        }


def _kind(one: Variable) -> str:
    """Return the kind of a variable that is set from outside, as the C names it."""
    if one.is_state:
        return "STATE"
    kinds = {"independent": "INDEPENDENT", "input": "INPUT"}
    return kinds.get(one.causality, one.variability.upper())


def _c_number(value: float) -> str:
    """Return a number as a constant of C."""
    return repr(float(value)) if math.isfinite(value) else ("HUGE_VAL" if value > 0 else "-HUGE_VAL")
