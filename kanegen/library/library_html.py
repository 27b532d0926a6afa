"""A library in a notebook: what it computes and how it is called, and the values of its parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from markupsafe import Markup

from kanegen.c import Source
from kanegen.c.source_html import functions_table, operation_words, variant_words
from kanegen.errors import counted
from kanegen.pictures.html import folded, python, sentence, shown, table


def library_html(source: Source, parameters: Mapping[str, float], arrays: Mapping[str, Sequence[str]]) -> str:
    """Return the HTML of a library for a notebook.

    Args:
        source: The generated code that was compiled.
        parameters: Values of the run-time parameters.
        arrays: Names of the elements of {x}, {y} and further arrays, by the name of the array.
    """
    model = source.model
    freedoms = counted(len(model.freedom_names), "freedom")
    values = [(name, repr(value)) for name, value in parameters.items()]
    elements = [(name, len(names), ", ".join(names)) for name, names in arrays.items() if names]
    return shown(
        sentence("{}, compiled {}", freedoms, variant_words(source.variant), strong=model.shown),
        functions_table(source.functions, "library."),
        sentence(
            "Arrays of B states, such as x of shape (B, {}), give B results. All outputs together take {}.",
            len(model.coordinate_names),
            operation_words(source.operations),
        ),
        folded("Elements of the arrays", table(("array", "length", "elements"), elements)),
        folded("Parameters", table(("name", "value"), values, "library.parameters"), _other_values(values))
        if values
        else Markup(""),
    )


def _other_values(values: Sequence[tuple[str, str]]) -> Markup:
    """Return the sentence on how to take other values."""
    name, value = values[0]
    example = python(f"library.with_parameters({{{name!r}: {value}}})")
    return sentence("{} returns the same library with other values.", example)
