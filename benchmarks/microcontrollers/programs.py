"""Programs for boards, which call functions of a model and print bits, instructions and stack."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kanegen.c import Source
from kanegen.c.declarations import declarator
from kanegen.c.formats import formats
from kanegen.c.interface import Function
from kanegen.program.ir import PARAMETERS, PREPARED, Array

HEAD = """#include "{model}.h"

#include "board.h"

static void print_number(const char *name, unsigned long value)
{{
    char digits[24];
    char *place = digits + sizeof digits;
    *--place = 0;
    *--place = '\\n';
    do {{
        *--place = (char)('0' + value%10);
        value /= 10;
    }} while (value);
    board_print(name);
    board_print(" = ");
    board_print(place);
}}

static void print_bits(const char *name, const void *values, size_t bytes)
{{
    const unsigned char *byte = values;
    board_print(name);
    for (size_t i = 0; i < bytes; ++i) {{
        const char *digits = "0123456789abcdef";
        const char text[] = {{i%4 ? '.' : ' ', digits[byte[i] >> 4], digits[byte[i] & 15], 0}};
        board_print(text);
    }}
    board_print("\\n");
}}
"""


def program_of_bits(source: Source, states: Mapping[str, np.ndarray], functions: Sequence[str]) -> str:
    """Return a program that prints the bits of all results of functions, for several states.

    Args:
        source: The code.
        states: Rows of every input array by its name; parameters and prepared constants are left out.
        functions: Names of functions.
    """
    chosen = _chosen(source, functions)
    count = len(next(iter(states.values())))
    lines = [HEAD.format(model=source.model.name), *_constants(source, states), *_results(source, chosen)]
    lines += ["int main(void)", "{"]
    if any(one.name == "prepare" for one in source.functions):
        lines.append(f"    if ({source.model.name}_prepare(parameters, prepared)) return 1;")
    lines.append(f"    for (int i = 0; i < {count}; ++i) {{")
    for function in chosen:
        lines.append(f'        print_number("status", (unsigned)({_call(source, function, "i")} + 1000));')
        lines += [
            f'        print_bits("{function.name} {array.name}", {array.name}, sizeof {array.name});'
            for array in function.outputs
        ]
    lines += ["    }", "    return 0;", "}", ""]
    return "\n".join(lines)


REPEATS = 200
"""Calls over which instructions are counted."""


def program_of_costs(
    source: Source, states: Mapping[str, np.ndarray], function: str, is_called: bool = True
) -> str:
    """Return a program that prints the stack of a function, and the ticks of `REPEATS` calls.

    These are those of twice as many calls less those of as many, with the loop around them.

    Args:
        source: The code.
        states: As for `program_of_bits`; the first row is the state.
        function: Name of the function.
        is_called: Whether the program calls it; without the call it shows what the rest of the program takes.
    """
    (chosen,) = _chosen(source, [function])
    call = _call(source, chosen, "0") if is_called else "0"
    lines = [HEAD.format(model=source.model.name), *_constants(source, states), *_results(source, [chosen])]
    lines += [
        "static volatile int status;",
        "static uint32_t ticks(int count)",
        "{",
        "    const uint32_t start = board_ticks();",
        "    for (int i = 0; i < count; ++i) {",
        f"        status = {call};",
        "    }",
        "    return board_ticks() - start;",
        "}",
        "int main(void)",
        "{",
    ]
    if any(one.name == "prepare" for one in source.functions):
        lines.append(f"    if ({source.model.name}_prepare(parameters, prepared)) return 1;")
    lines += [
        "    board_mark_stack();",
        f"    status = {call};",
        '    print_number("stack", (unsigned long)board_used_stack());',
        f"    const uint32_t once = ticks({REPEATS});",
        f'    print_number("ticks", (unsigned long)(ticks({2 * REPEATS}) - once));',
        "    return 0;",
        "}",
        "",
    ]
    return "\n".join(lines)


def _chosen(source: Source, functions: Sequence[str]) -> list[Function]:
    by_name = {one.name: one for one in source.functions}
    return [by_name[name] for name in functions]


def _call(source: Source, function: Function, row: str) -> str:
    """Return the call of a function with a row of the states."""
    inputs = [
        array.name if array.name in (PARAMETERS, PREPARED) else f"{array.name}_rows[{row}]"
        for array in function.inputs
    ]
    arguments = [*inputs, *(array.name for array in function.outputs)]
    return f"{source.model.name}_{function.name}({', '.join(arguments)})"


def _constants(source: Source, states: Mapping[str, np.ndarray]) -> list[str]:
    """Return the declarations of the input arrays, with exact numbers."""
    precisions = formats(source.variant)
    lines = []
    for name, rows in states.items():
        kind, size = precisions.of(name), rows[0].size
        texts = [f"{{{', '.join(_literal(v, kind.c_type) for v in row.ravel())}}}" for row in rows]
        lines.append(f"static const {kind.c_type} {name}_rows[{len(rows)}][{size}] = {{")
        lines += [f"    {text}," for text in texts] + ["};"]
    if source.model.parameters:
        kind = precisions.of(PARAMETERS)
        values = ", ".join(_literal(value, kind.c_type) for _, value in source.model.parameters)
        lines.append(f"static const {kind.c_type} parameters[] = {{{values}}};")
    return lines


def _literal(value: float, c_type: str) -> str:
    number = float(np.float32(value)) if c_type == "float" else float(value)
    return f"{number.hex()}{'f' if c_type == 'float' else ''}"


def _results(source: Source, functions: Sequence[Function]) -> list[str]:
    """Return the declarations of the arrays that functions fill."""
    precisions = formats(source.variant)
    arrays: dict[str, Array] = {array.name: array for one in functions for array in one.outputs}
    arrays |= {
        array.name: array for one in source.functions if one.name == "prepare" for array in one.outputs
    }
    return [f"static {precisions.of(name).c_type} {declarator(array)};" for name, array in arrays.items()]


def random_inputs(
    source: Source, functions: Sequence[str], count: int, seed: int = 0
) -> dict[str, np.ndarray]:
    """Return rows of every input array of some functions: numbers over (-1, 1), and steps of 1 ms."""
    rng = np.random.default_rng(seed)
    arrays = {array.name: array for one in _chosen(source, functions) for array in one.inputs}
    return {
        name: np.full((count, 1), 1e-3) if name == "step" else rng.uniform(-1.0, 1.0, (count, array.size))
        for name, array in arrays.items()
        if name not in (PARAMETERS, PREPARED)
    }
