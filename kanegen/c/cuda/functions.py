"""The functions of a model in CUDA: a device function for one state, its kernel, and what launches it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kanegen.c.cuda.dialect import template
from kanegen.c.cuda.teams import WARP, Team, state
from kanegen.c.declarations import argument_row
from kanegen.c.formats import Formats
from kanegen.c.functions import Code, PrintedFunction
from kanegen.c.interface import Function
from kanegen.c.layout import BREAK, WIDTH, columns, wrap
from kanegen.c.target import RenderInput
from kanegen.program.ir import PARAMETERS, PREPARED, Array

SHARED = (PARAMETERS, PREPARED)
"""Arrays of which all states have one set, where the parameters do not differ by state."""


@dataclass(frozen=True)
class CudaFunction:
    """One function of a model as lines of CUDA C++.

    Attributes:
        name: Name with the prefix of the model.
        signature: Arguments and conditions.
        is_for_all: Whether it computes one set of results for all states, as `prepare` may.
        arguments: Documentation of the arguments of the device function.
        template: The line of its template parameters, the types of its arguments.
        device_prototype: Its prototype.
        code: Its body and its parts.
        kernel_prototype: Prototype of the kernel.
        device_call: Call of the device function in the kernel, for state `i`.
        launcher_arguments: Documentation of the function that launches the kernel.
        launcher_prototype: Its prototype.
        launch: Lines between its braces.
        team: What each warp of the kernel computes, None where a thread computes a state.
    """

    name: str
    signature: Function
    is_for_all: bool
    arguments: list[str]
    template: list[str]
    device_prototype: list[str]
    code: Code
    kernel_prototype: list[str]
    device_call: list[str]
    launcher_arguments: list[str]
    launcher_prototype: list[str]
    launch: list[str]
    team: Team | None


def cuda_functions(
    render_input: RenderInput, printed: Sequence[PrintedFunction], teams: Mapping[str, Team | None]
) -> list[CudaFunction]:
    """Return every function of outputs, and `prepare`, in CUDA C++.

    Args:
        render_input: Model and precisions, for functions of one state.
        printed: The functions in C, whose bodies device functions have, too.
        teams: The form for teams of warps, by name of the function, None where a thread computes a state.
    """
    by_state = render_input.parameters_by_state
    shared = () if by_state else SHARED
    return [_function(one, render_input.formats, shared, teams[one.signature.name]) for one in printed]


def _function(
    one: PrintedFunction, formats: Formats, shared: Sequence[str], team: Team | None
) -> CudaFunction:
    """Return a function in CUDA C++.

    Args:
        one: The function in C.
        formats: Precisions of arrays.
        shared: Names of arrays that all states have in common.
        team: Its form for teams of warps, None without.
    """
    signature = one.signature
    arrays = (*signature.inputs, *signature.outputs)
    arguments = f",{BREAK}".join(f"{array.name}_type {array.name}" for array in arrays)
    threads, _ = _block(team)
    return CudaFunction(
        name=one.name,
        signature=signature,
        is_for_all=_is_for_all(signature, shared),
        arguments=one.arguments,
        template=_lines(template([array.name for array in arrays])),
        device_prototype=_lines(f"static __device__ __forceinline__ int {one.name}_device({arguments})"),
        code=one.code,
        kernel_prototype=_lines(
            f"{_KERNEL}({threads}){BREAK}{one.name}_kernel({_kernel_arguments(signature, formats, shared)})"
        ),
        device_call=_device_call(one.name, arrays, shared),
        launcher_arguments=_launcher_arguments(one, shared),
        launcher_prototype=_launcher_prototype(one.name, signature, formats, shared),
        launch=_launch(one.name, signature, shared, team),
        team=team,
    )


_KERNEL = f'extern "C" __global__ void{BREAK}__launch_bounds__'


def _block(team: Team | None) -> tuple[str, str]:
    """Return the numbers of threads and of states of a block."""
    if team is None:
        return "KANEGEN_THREADS", "KANEGEN_THREADS"
    return f"{WARP * len(team.workers)}U", f"{WARP}U"


def _lines(text: str) -> list[str]:
    return wrap(text, indent="", hanging="    ")


def _pointers(signature: Function, formats: Formats, qualifier: str = "") -> list[str]:
    """Return the declarations of the arrays with all states, inputs first."""
    inputs = [f"const {formats.of(array.name).c_type} *{qualifier}{array.name}" for array in signature.inputs]
    outputs = [f"{formats.of(array.name).c_type} *{qualifier}{array.name}" for array in signature.outputs]
    return [*inputs, *outputs]


def _kernel_arguments(signature: Function, formats: Formats, shared: Sequence[str]) -> str:
    counts = [] if _is_for_all(signature, shared) else ["size_t count", "size_t stride"]
    arrays = _pointers(signature, formats, "__restrict__ ")
    return f",{BREAK}".join([*counts, *arrays, "int *__restrict__ status"])


def _is_for_all(signature: Function, shared: Sequence[str]) -> bool:
    """Return whether a function computes one set of results for all states, as `prepare` may."""
    return all(array.name in shared for array in signature.outputs)


def _launcher_prototype(name: str, signature: Function, formats: Formats, shared: Sequence[str]) -> list[str]:
    is_for_all = _is_for_all(signature, shared)
    counts = [] if is_for_all else ["size_t count", "size_t stride"]
    arguments = ["cudaStream_t stream", *counts, *_pointers(signature, formats), "int *status"]
    suffix = "cuda" if is_for_all else "batch_cuda"
    return _lines(f"cudaError_t {name}_{suffix}({f',{BREAK}'.join(arguments)})")


def _device_call(name: str, arrays: Sequence[Array], shared: Sequence[str]) -> list[str]:
    """Return the statement that computes state `i` in a kernel."""
    arguments = [array.name if array.name in shared else state(array) for array in arrays]
    text = f"const int found = {name}_device({f',{BREAK}'.join(arguments)});"
    indent = " " * (4 if all(array.name in shared for array in arrays) else 8)
    return wrap(text, indent=indent, hanging=f"{indent}    ")


def _launch(name: str, signature: Function, shared: Sequence[str], team: Team | None) -> list[str]:
    """Return the statement that launches a kernel."""
    is_for_all = _is_for_all(signature, shared)
    block = _block(team)
    launched = ["1U", "1U", "stream", "1U"] if is_for_all else [*block, "stream", "count", "count", "stride"]
    arrays = (array.name for array in (*signature.inputs, *signature.outputs))
    values = [f"{name}_kernel", *launched, *arrays, "status"]
    return wrap(f"return kanegen_launch({f',{BREAK}'.join(values)});")


def _launcher_arguments(one: PrintedFunction, shared: Sequence[str]) -> list[str]:
    """Return Doxygen lines for arguments and statuses of the function that launches a kernel."""
    signature = one.signature
    rows = [
        ("@param[in]", "stream", "", "the stream of the kernel"),
        ("@param[in]", "count", "", "number of states"),
        ("@param[in]", "stride", "", "numbers from one element to the next, at least `count`; 0 for rows"),
    ]
    is_for_all = _is_for_all(signature, shared)
    if is_for_all:
        del rows[1:]
    for direction, arrays in (("[in]", signature.inputs), ("[out]", signature.outputs)):
        rows += [_row(direction, array, array.name in shared) for array in arrays]
    rows.append(("@param[out]", "status", "[1]" if is_for_all else "[count]", "statuses, or NULL"))
    start = next(k for k, line in enumerate(one.arguments) if line.startswith("@return"))
    statuses = [one.arguments[start].replace("@return ", "Status: ", 1), *one.arguments[start + 1 :]]
    return [*columns(rows, width=WIDTH - len(" * ")), "", *statuses]


def _row(direction: str, array: Array, is_shared: bool) -> tuple[str, str, str, str]:
    """Return the row of an array in the table of arguments, with its lengths in a batch."""
    name, label, lengths, meaning = argument_row(direction, array)
    return name, label, lengths if is_shared else f"{lengths}[stride]", meaning
