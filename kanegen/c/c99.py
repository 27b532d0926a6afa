"""The target C99: a header and sources for one state and for batches, in every precision.

The variants of the code follow from `Variant`: double, single, long double and double-double arithmetic,
arrays of another precision than the arithmetic, and batches in SIMD vectors where the precision has them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from kanegen.c import usage
from kanegen.c.context import Context, context
from kanegen.c.declarations import prepared_places
from kanegen.c.dialect import Dialect, finite_test, scalar
from kanegen.c.double_double_elementary import DOUBLE_DOUBLE_ELEMENTARY
from kanegen.c.elementary import ELEMENTARY, elementary_header
from kanegen.c.footprint import footprints
from kanegen.c.functions import Code, PrintedFunction, printed_functions
from kanegen.c.interface import PREPARE, Function
from kanegen.c.nomenclature import nomenclature
from kanegen.c.pieces import divided
from kanegen.c.printed_steps import PrintedRollout, printed_steps
from kanegen.c.simd import SIMD, Simd
from kanegen.c.target import Printed, RenderInput
from kanegen.c.templates import fill
from kanegen.c.versions import VERSIONS, Dispatched, defined_names, included, macros_of_width
from kanegen.errors import ModelError
from kanegen.model.names import FILES_OF_C
from kanegen.options import STRICT
from kanegen.program.cut import LONGEST_PART
from kanegen.program.precision import DOUBLE, DOUBLE_DOUBLE, PRECISIONS
from kanegen.program.triangle import FULL
from kanegen.recursion.outputs import OUTPUTS, prerequisites
from kanegen.recursion.outputs.output import OfSolution

FILES = {
    "{name}.h": "model.h",
    "{name}.c": "model.c",
    "{name}_batch.c": "model_batch.c",
    "kanegen_simd{f}.h": "kanegen_simd.h",
    "kanegen_sincos{f}.h": "kanegen_sincos.h",
    "kanegen_double_double.h": "kanegen_double_double.h",
}
"""Template of every file of code by the name of the file; {f} is the suffix of the precision, "" or "f"."""

VERSION_FILES = {"{name}.c": "{name}_version.h", "{name}_batch.c": "{name}_batch_version.h"}
"""The file with the functions, by that of the file that includes it for several instruction sets."""

_NEEDED = {
    "model_batch.c": "has_batches",
    "kanegen_simd.h": "has_lanes",
    "kanegen_sincos.h": "sincos",
    "kanegen_double_double.h": "double_double",
}
"""Name of the context variable by template; a file is left out where this variable is empty."""


@dataclass(frozen=True)
class C99:
    """Portable C99, which C++ programs can include.

    Attributes:
        name: Name of the target, as users write it.
        longest_part: Instructions of a function from which it is cut into parts.
        has_loops: Whether it prints solutions in loops over columns.
    """

    name: str = "c99"
    longest_part: int = LONGEST_PART
    has_loops: bool = True

    def require_name(self, name: str) -> None:
        """Refuse the name of a header of the C library, or of the example.

        Raises:
            ModelError: If `name` is reserved.
        """
        if name.lower() in FILES_OF_C:
            raise ModelError(
                f"system name {name!r}: the file {name}.h or {name}.c would hide another. "
                "Choose another name."
            )

    def dialect(self, render_input: RenderInput, function: Function) -> Dialect:
        """Return C for one state; `prepare` computes at least in double precision."""
        formats = render_input.formats
        arithmetic = formats.preparing if function.name == PREPARE else formats.arithmetic
        kanegen_sincos = render_input.sincos is not None and arithmetic is formats.arithmetic
        in_pieces = render_input.pieces > 0
        return scalar(
            formats, arithmetic, kanegen_sincos, render_input.places, render_input.batches, in_pieces
        )

    def printed(self, render_input: RenderInput) -> Printed:
        """Return header, source, batch source and the headers that these include."""
        variables = self._context(render_input)
        double_double = variables["double_double"]
        files = {
            pattern.format(name=render_input.model.name, f=render_input.precision.libm_suffix): fill(
                f"c99/{template}", **variables
            )
            for pattern, template in FILES.items()
            if template not in _NEEDED or variables[_NEEDED[template]]
        }
        files |= _elementary_headers(variables["functions"])
        if render_input.variant.is_multiversioned:
            files |= _versions(files, variables)
        types = double_double.declared if double_double else ""
        return Printed(
            files, types + variables["declarations"], variables["footprints"], _pieces(files, variables)
        )

    def _context(self, render_input: RenderInput) -> Context:
        """Return the variables of all templates."""
        steps, rollouts = printed_steps(render_input)
        outputs = printed_functions(render_input, self)
        printed = [*outputs, *steps]
        variables = context(
            render_input.model,
            render_input.functions,
            (*render_input.outputs, *render_input.steps),
            render_input.operations,
            render_input.variant,
            [one.step for one in render_input.rollouts],
        )
        pieces, batch_pieces = (
            divided([part for one in codes for part in one.parts], render_input.pieces)
            for codes in ([one.code for one in printed], [one.simd_code for one in printed])
        )
        variables |= {
            "choices": printed_choices(render_input, printed),
            "functions": _without_parts(printed) if render_input.pieces else printed,
            "pieces": pieces,
            "batch_pieces": batch_pieces,
            "has_parts": any(one.code.parts for one in printed),
            "rollouts": rollouts,
            "steps": [*steps, *rollouts],
            "nomenclature": nomenclature(printed, _text_of_steps(steps, rollouts)),
            "prepared_places": prepared_places(render_input.model, render_input.prepared),
            "finite_tests": _finite_tests(render_input),
            "stack": render_input.batch_stack,
            "vector_sincos": max(function.code.vector_sincos for function in printed),
            "has_sines": any(function.code.has_sines for function in printed),
            "has_lower": any(one.is_filled_in_part for f in render_input.functions for one in f.outputs),
            "has_columns": _has_columns_in_lanes(function.code for function in printed),
            "footprints": footprints(render_input, outputs),
            "scalar_headers": _header_names(function.code for function in printed),
            "batch_headers": _header_names(function.simd_code for function in printed),
        }
        return {**variables, "declarations": fill("c99/declarations.h", **variables)}


def _without_parts(functions: Sequence[PrintedFunction]) -> list[PrintedFunction]:
    """Return functions whose parts stand in pieces."""
    return [
        replace(one, code=replace(one.code, parts=()), simd_code=replace(one.simd_code, parts=()))
        for one in functions
    ]


def _pieces(files: Mapping[str, str], variables: Context) -> dict[str, int]:
    """Return the number of pieces of each file that has several."""
    name = variables["model"].name
    numbers = {f"{name}.c": variables["pieces"].number, f"{name}_batch.c": variables["batch_pieces"].number}
    return {file: number for file, number in numbers.items() if number and file in files}


def _versions(files: Mapping[str, str], variables: Context) -> dict[str, str]:
    """Return the files of a model whose functions are compiled for several instruction sets.

    Args:
        files: The files for one instruction set, of which the headers stay.
        variables: The variables of all templates.
    """
    found = {"kanegen_versions.h": fill("c99/kanegen_versions.h", versions=VERSIONS)}
    common = {name: text for name, text in files.items() if name.startswith("kanegen_")}
    for patterns in VERSION_FILES.items():
        file, version_file = (pattern.format(name=variables["model"].name) for pattern in patterns)
        if file in files:
            headers = included(files[file], common)
            batch = file.endswith("_batch.c")
            of_file = variables | {
                "batch": batch,
                "pieces": variables["batch_pieces" if batch else "pieces"],
                "version_file": version_file,
                "own": defined_names([*headers, files[file]]),
                "macros": macros_of_width(headers),
                "dispatched": _dispatched(variables, file),
                "versions": VERSIONS,
            }
            found[file] = fill("c99/versions.c", **of_file)
            found[version_file] = fill("c99/version.h", **of_file)
    return found


def _dispatched(variables: Context, file: str) -> list[Dispatched]:
    """Return the functions of a file that users call."""
    every: list[PrintedFunction | PrintedRollout] = [*variables["functions"], *variables["rollouts"]]
    if not file.endswith("_batch.c"):
        return [Dispatched.of(one.name, one.prototype) for one in every]
    batches = [one for one in every if one.signature.has_batch]
    return [Dispatched.of(f"{one.name}_batch", one.batch_prototype) for one in batches]


def _text_of_steps(steps: Sequence[PrintedFunction], rollouts: Sequence[PrintedRollout]) -> str:
    """Return the text for one state of all functions that follow a motion."""
    bodies = ["\n".join((one.code.before, *one.code.body)) for one in steps]
    return "\n".join([*bodies, *(one.code for one in rollouts)])


def _header_names(codes: Iterable[Code]) -> list[str]:
    """Return the headers of elementary functions that some functions call, each once."""
    called = dict.fromkeys(code.elementary for code in codes if code.elementary is not None)
    return [f"{elementary_header(precision)}.h" for precision in called]


def _has_columns_in_lanes(codes: Iterable[Code]) -> bool:
    """Return whether some functions solve for columns in SIMD lanes."""
    return any(code.has_columns_in_lanes for code in codes)


def _elementary_headers(functions: Sequence[PrintedFunction]) -> dict[str, str]:
    """Return the text of every header of elementary functions that is included, by its name."""
    called = {code.elementary for function in functions for code in (function.code, function.simd_code)}
    precisions = [precision for precision in PRECISIONS.values() if precision in called]
    if DOUBLE_DOUBLE in called and DOUBLE not in called:
        precisions.insert(0, DOUBLE)
    return {
        f"{elementary_header(precision)}.h": fill(
            "c99/kanegen_elementary_dd.h", elementary_dd=DOUBLE_DOUBLE_ELEMENTARY
        )
        if precision is DOUBLE_DOUBLE
        else fill("c99/kanegen_elementary.h", elementary=ELEMENTARY[precision])
        for precision in precisions
    }


@dataclass(frozen=True)
class FiniteTest:
    """A function in C that tests whether all numbers of an array are finite.

    Attributes:
        name: Name of the function.
        type: Type of the numbers.
        simd: Bit patterns of the numbers; None where the test subtracts them from themselves.
    """

    name: str
    type: str
    simd: Simd | None


def _finite_tests(render_input: RenderInput) -> list[FiniteTest]:
    """Return the test for every precision of results that may be infinite or NaN."""
    outputs = [
        array.name
        for function, parts in render_input.programs.items()
        for array in function.outputs
        if usage.variable_runs(parts, array, function.looped)
    ]
    of_states = [render_input.formats.storage] if render_input.steps else []
    precisions = dict.fromkeys((*map(render_input.formats.of, outputs), *of_states))
    return [FiniteTest(finite_test(one), one.c_type, SIMD.get(one)) for one in precisions]


def printed_choices(render_input: RenderInput, printed: Sequence[PrintedFunction]) -> list[tuple[str, str]]:
    """Return the name of every choice that shaped the code, with the value and its reason."""
    solved = [
        OUTPUTS[name] for name in prerequisites([name for name in render_input.outputs if name in OUTPUTS])
    ]
    has_solution = any(isinstance(output.derivation, OfSolution) for output in solved)
    codes = [code for function in printed for code in (function.code, function.simd_code)]
    applies = {
        "precision": True,
        "storage": render_input.formats.is_mixed,
        "sincos": any(code.takes_sines for code in codes),
        "solver": has_solution,
        "refinement": has_solution,
    }
    usual = dict(STRICT.choices())
    found = [
        (name, value)
        for name, value in render_input.variant.choices(render_input.decided)
        if applies.get(name, value != usual[name])
    ]
    outputs = [array for function in render_input.functions for array in function.outputs]
    forms = dict.fromkeys(array.form for array in outputs if array.form != FULL)
    found += [("mass_matrix", form) for form in forms]
    return [*found, ("parameters", "by state")] if render_input.parameters_by_state else found


C99_TARGET = C99()
"""The target that is used unless another is asked for."""
