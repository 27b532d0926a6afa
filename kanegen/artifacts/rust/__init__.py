"""The artifact "rust": a crate without the standard library that compiles the C and calls it safely.

The folder `rust/` holds copies of the C, declarations of its functions in `src/sys.rs`, and methods that take
arrays of the right lengths, so that no call can reach beyond one. `names` has what names become in Rust,
`arguments` what a user passes and C gets, `methods` the text of the methods.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from kanegen import __version__
from kanegen.artifacts.loads import with_rows_read
from kanegen.artifacts.rust.arguments import (
    PAIR,
    SCALARS,
    Argument,
    Types,
    of_batch,
    of_rollout,
    of_state,
)
from kanegen.artifacts.rust.calls import call_of, values
from kanegen.artifacts.rust.methods import batch, methods_of, outputs_of, rollout, rollout_batch
from kanegen.artifacts.rust.names import crate_name, listed, string
from kanegen.artifacts.rust.tables import columns, shown_requirements, sizes, structs, tables
from kanegen.c.formats import formats
from kanegen.c.interface import PREPARE, Function
from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.program.ir import PREPARED
from kanegen.program.precision import DOUBLE_DOUBLE

FOLDER = "rust"
"""Folder of the crate."""

_TEMPLATES = {
    "Cargo.toml": "Cargo.toml",
    "README.md": "README.md",
    "build.rs": "build.rs",
    "src/lib.rs": "lib.rs",
    "src/model.rs": "model.rs",
    "src/status.rs": "status.rs",
    "src/structs.rs": "structs.rs",
    "src/names.rs": "names.rs",
    "src/sys.rs": "sys.rs",
    "examples/evaluate.rs": "evaluate.rs",
}
"""Template of every file of a crate."""


def rust(source: Source) -> dict[str, str]:
    """Return the text of every file of the crate, by its path."""
    variables = _variables(source)
    files = {name: fill(f"artifacts/rust/{template}", **variables) for name, template in _TEMPLATES.items()}
    if source.has_batches:
        files["tests/functions.rs"] = fill("artifacts/rust/functions.rs", **variables)
    if variables["columns"]:
        files["src/columns.rs"] = fill("artifacts/rust/columns.rs", **variables)
    files |= {f"c/{name}": _without_provenance(text) for name, text in source.code.items()}
    return {f"{FOLDER}/{name}": text for name, text in files.items()}


def refusal(source: Source) -> str:
    """Return why there is no crate of `source`, "" if there is."""
    model_formats = formats(source.variant)
    arrays = {array.name for function in source.functions for array in (*function.inputs, *function.outputs)}
    kinds = {model_formats.of(name) for name in arrays if name != PREPARED}
    if PREPARED in arrays and model_formats.of(PREPARED) is not DOUBLE_DOUBLE:
        kinds.add(model_formats.of(PREPARED))
    foreign = sorted(one.name for one in kinds if one.c_type not in SCALARS)
    if not foreign:
        return ""
    return (
        f"Rust has no numbers in {foreign[0]}, which arrays of this code hold. Choose --precision double or "
        "float, or --storage double."
    )


def _without_provenance(text: str) -> str:
    """Return a file below its first line, which every file of an artifact gets anew."""
    return text.partition("\n")[2]


def _variables(source: Source) -> dict[str, Any]:
    """Return the variables of all templates."""
    model, types = source.model, Types(formats(source.variant))
    functions = [with_rows_read(one, model) for one in source.functions if one.name != PREPARE]
    rollouts = [replace(one, step=with_rows_read(one.step, model)) for one in source.rollouts]
    prepare = next((one for one in source.functions if one.name == PREPARE), None)
    crate = crate_name(model.name, source.variant.precision)
    scalar = types.number(functions[0].outputs[0])
    methods = [method for function in functions for method in methods_of(model.name, function, types)]
    for one in rollouts:
        batches = [rollout_batch(model.name, one, types)] * source.has_batches
        methods += [rollout(model.name, one, types), *batches]
    calls = [call_of(one, types) for one in functions]
    members = structs(model, types.formats, scalar, types.number(prepare.inputs[0]) if prepare else "")
    return {
        "version": __version__,
        "model": model,
        "crate": crate,
        "crate_path": f"{model.name}/{FOLDER}",
        "c_files": [string(f"c/{name}") for name in source.code if name.endswith(".c")],
        **_flags(source),
        "symbols": [(name, own) for name, own, _ in _foreign(source, types, crate) if name != own],
        "functions": functions,
        "rollouts": rollouts,
        "has_held": any(one.held for one in rollouts),
        "has_batches": source.has_batches,
        "needs_error": source.has_batches or bool(source.rollouts),
        "prepared": _prepared(prepare, types) if prepare else None,
        "prepare_batch": batch(model.name, prepare, types) if prepare and prepare.has_batch else None,
        "methods": methods,
        "outputs": [found for one in functions if (found := outputs_of(one, types))],
        "foreign": list(_foreign(source, types, crate)),
        "structs": members,
        "struct_names": sorted(one.name for one in members),
        "requirements": shown_requirements(source),
        "may_not_converge": source.may_not_converge,
        "not_converged": model.not_converged,
        "tables": list(tables(source, types.formats, scalar)),
        "sizes": sizes(model),
        "columns": columns(source),
        "calls": calls,
        "values": values(functions, types),
        "use": _use(functions, types),
    }


def _flags(source: Source) -> dict[str, Any]:
    """Return the variables of the flags of the C compiler."""
    flags = [flag for flag in source.variant.flags if not flag.startswith("-O")]
    return {
        "flags": flags,
        "flags_text": " ".join(f"`{flag}`" for flag in flags),
        "level": source.variant.optimisation,
    }


def _prepared(prepare: Function, types: Types) -> dict[str, Any]:
    """Return the variables of the prepared constants."""
    (array,) = prepare.outputs
    zeros = types.of(array).replace(types.number(array), "[0.0; 2]" if types.number(array) == PAIR else "0.0")
    return {
        "kind": types.of(array),
        "zeros": zeros,
        "may_fail": bool(prepare.may_fail),
        "quantity": prepare.quantity,
    }


def _foreign(source: Source, types: Types, crate: str) -> Iterator[tuple[str, str, list[str]]]:
    """Yield name in C, symbol and declaration of every C function."""
    model = source.model.name
    own = crate if source.variant.precision != "double" else model
    for function in source.functions:
        forms = {function.name: (of_state(function, types), "c_int")}
        if function.has_batch:
            forms[f"{function.name}_batch"] = of_batch(function, types), "usize"
        for name, (arguments, result) in forms.items():
            yield f"{model}_{name}", f"{own}_{name}", _declaration(f"{model}_{name}", arguments, result)
    for one in source.rollouts:
        both = [(one.name, False, "c_int"), (f"{one.name}_batch", True, "usize")]
        for name, each, result in both if source.has_batches else both[:1]:
            declaration = _declaration(f"{model}_{name}", of_rollout(one, types, each), result)
            yield f"{model}_{name}", f"{own}_{name}", declaration


def _declaration(name: str, arguments: Sequence[Argument], result: str) -> list[str]:
    """Return the declaration of a C function."""
    count = ["count: usize"] * (result == "usize")
    foreign = [text for one in arguments for text in one.foreign]
    return listed(f"pub fn {name}(", [*count, *foreign], f") -> {result};", "    ")


def _use(functions: Sequence[Function], types: Types) -> dict[str, Any]:
    """Return the variables of the example of the README: forward dynamics, or the first function."""
    shown = next((one for one in functions if one.name == "forward_dynamics"), functions[0])
    call = call_of(shown, types)
    return {
        "name": call.name,
        "given": call.given,
        "result": "outputs" if call.struct else call.results[0][0],
        "inputs": values([shown], types),
    }
