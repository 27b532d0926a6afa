"""Generated code in a notebook: its functions, what one evaluation costs, and the C itself, folded."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from markupsafe import Markup

from kanegen.c.interface import PREPARE, Function
from kanegen.errors import counted
from kanegen.options import STRICT, Variant
from kanegen.pictures.html import code, folded, python, sentence, shown, table
from kanegen.program.ir import EVALUATE, PARAMETERS, PREPARED

_WORDS = {
    "add": ("addition",),
    "multiply": ("multiplication",),
    "divide": ("division",),
    "sqrt": ("square root",),
    "sincos": ("sine with cosine", "sines with cosines"),
    "compare": ("comparison",),
    "function": ("call of a function", "calls of functions"),
}
"""Kinds of operations in words: for one, and for several where these have no s at the end alone."""


def source_html(
    title: str,
    functions: Iterable[Function],
    operations: Mapping[str, int],
    files: Mapping[str, str],
    variant: Variant,
) -> str:
    """Return the HTML of a source for a notebook.

    Args:
        title: Name of the system.
        functions: The functions that it defines.
        operations: Operations of one evaluation of all outputs, by kind.
        files: Text of every file by its name.
        variant: The choices that shaped the code.
    """
    return shown(
        sentence(
            "{}, one evaluation takes {}", variant_words(variant), operation_words(operations), strong=title
        ),
        functions_table(functions, ""),
        *(
            folded(
                Markup("<code>{}</code>, {}").format(name, counted(text.count("\n"), "line")),
                code(text, f"print(source.files[{name!r}])"),
            )
            for name, text in files.items()
        ),
        sentence("{} writes all files.", python('source.write("build")')),
    )


def variant_words(variant: Variant) -> str:
    """Return the precision, and every other choice that is not the usual one, in words."""
    usual = dict(STRICT.choices())
    others = [f"{name} {value}" for name, value in variant.choices() if value != usual[name]]
    return ", ".join(
        [f"C in {variant.precision}", *(one for one in others if not one.startswith("precision "))]
    )


def operation_words(operations: Mapping[str, int]) -> str:
    """Return the numbers of operations of one evaluation that are not zero, in words."""
    counts = [
        counted(number, *_WORDS[kind]) for kind, number in operations.items() if number and kind != PREPARE
    ]
    prepared = operations.get(PREPARE, 0)
    once = f"; {prepared} more run once for each set of parameters" if prepared else ""
    return ", ".join(counts) + once


def functions_table(functions: Iterable[Function], owner: str) -> Markup:
    """Return the table of functions, with arguments, shape, unit and meaning of what each returns.

    Args:
        functions: The functions; that of all outputs together and the prepared constants are left out.
        owner: What stands before their names, such as "library.".
    """
    rows = [
        (
            python(f"{owner}{one.name}({', '.join(_arguments(one))})"),
            str(array.shape) if array.shape else "number",
            array.unit,
            array.doc,
        )
        for one in functions
        if one.name not in (PREPARE, EVALUATE)
        for array in one.outputs
    ]
    return table(("function", "shape", "unit", "meaning"), rows, "source.functions")


def _arguments(function: Function) -> Iterable[str]:
    """Return the names of the arrays that a caller passes for a state."""
    return (array.name for array in function.inputs if array.name not in (PARAMETERS, PREPARED))
