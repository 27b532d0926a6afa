"""The artifact "arduino": one folder that is a library for Arduino, PlatformIO, Zephyr and ESP-IDF.

The folder follows revision 2.2 of Arduino's library specification. It holds its own copy of the C, with the
functions for one state alone; they allocate nothing and keep no state. The build files of the other systems
stand in the same folder, so that it can be copied into a project as it is.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace

from kanegen.artifacts.example import inputs, results
from kanegen.c.context import Context, context
from kanegen.c.formats import Formats, formats
from kanegen.c.render import printed, target_named
from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.errors import quoted
from kanegen.model.quoting import c_name
from kanegen.program.precision import DOUBLE

HEADERS_OF_ARDUINO = frozenset(
    """
    arduino binary bridge cdc client eeprom esplora ethernet firmata gsm hardwareserial ipaddress keyboard
    liquidcrystal mouse new pins_arduino pluggableusb print printable robot_control sd server servo
    softwareserial spi stepper stream temboo tft udp usbapi usbcore wifi wire wiring_private wstring
    """.split()
)
"""Names, in lower case, of headers of Arduino's core and of its own libraries."""

_LIBRARY_FILES = {
    "library.properties": "library.properties",
    "library.json": "library.json",
    "README.md": "README.md",
    "keywords.txt": "keywords.txt",
    "CMakeLists.txt": "CMakeLists.txt",
    "idf_component.yml": "idf_component.yml",
    "zephyr/module.yml": "module.yml",
    "examples/Basic/Basic.ino": "Basic.ino",
}
"""Template of each file of the folder that is no code, by its path."""


def refusal(source: Source) -> str:
    """Return why `source` cannot be such a library, "" if it can."""
    name = source.model.name
    if name.lower() in HEADERS_OF_ARDUINO:
        return f"the header {name}.h would hide one of Arduino's. Give the system another name: --name NAME."
    if source.render_input is None:
        return f"the source of {quoted(source.model.shown)} does not carry its programs. Generate it anew."
    return ""


def arduino(source: Source) -> dict[str, str]:
    """Return the text of every file below `arduino/<model>/`, by its path."""
    if source.render_input is None:
        raise ValueError("refusal(source) says that this source cannot be such a library.")
    code = printed(replace(source.render_input, batches=False), target_named(source.target))
    variables = _variables(code)
    files = {path: fill(f"artifacts/arduino/{name}", **variables) for path, name in _LIBRARY_FILES.items()}
    files |= {f"src/{name}": text.partition("\n")[2] for name, text in code.files.items()}
    return {f"arduino/{source.model.name}/{path}": text for path, text in files.items()}


def _variables(code: Source) -> Context:
    """Return the variables of the templates."""
    outputs, model_formats = (*code.outputs, *code.integrators), formats(code.variant)
    steps = [one.step for one in code.rollouts]
    names = [*(one.name for one in code.functions), *(one.name for one in code.rollouts)]
    variables = context(code.model, code.functions, outputs, code.operations, code.variant, steps)
    return variables | {
        "functions": code.functions,
        "footprints": code.footprints,
        "description": json.dumps(f"Kane's equations of motion of the model {c_name(code.model.shown)}"),
        "called": [f"{code.model.name}_{name}" for name in names],
        "constants": re.findall(rf"^    ({code.model.prefix}_\w+) *=", code.cdef, re.MULTILINE),
        "inputs": inputs(code.model, code.functions, model_formats),
        "results": results(code.functions, model_formats),
        "numbers": _numbers(code, model_formats),
        "digits": min(model_formats.storage.decimal_digits, DOUBLE.decimal_digits),
        "options": [flag for flag in code.variant.flags if not flag.startswith(("-O", "-m"))],
    }


def _numbers(code: Source, model_formats: Formats) -> dict[str, str]:
    """Return the expression of element i of a printed array `values`, by the type of its elements."""
    printed_arrays = [array for function in code.functions for array in function.outputs]
    kinds = dict.fromkeys(model_formats.of(array.name) for array in printed_arrays)
    return {kind.c_type: "values[i].high" if kind.trailing_shape else "values[i]" for kind in kinds}
