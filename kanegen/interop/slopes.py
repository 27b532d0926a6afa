"""Which generated functions give the derivatives of others, for programs that differentiate their callers."""

from __future__ import annotations

from collections.abc import Collection, Container, Iterable, Mapping
from dataclasses import dataclass

from kanegen.c import Source
from kanegen.errors import OptionError, quoted
from kanegen.model.system import System
from kanegen.program.ir import PARAMETERS
from kanegen.recursion.outputs import DERIVATIVES, INTEGRATORS, OUTPUTS, PRODUCTS, available, differentiates
from kanegen.recursion.outputs.integrators import STEP

_FACTORS = {
    "inverse_dynamics": ("ydot", "mass_matrix"),
    "frame_velocities": ("y", "frame_jacobians"),
    "frame_accelerations": ("ydot", "frame_jacobians"),
    "point_accelerations": ("ydot", "point_jacobians"),
}
"""For an output that is a matrix times an input and more, the input and the output that is the matrix."""


@dataclass(frozen=True)
class Slopes:
    """Derivatives of the results of a function, as another generated function gives them.

    Attributes:
        function: Name of the function that gives them.
        columns: For each input that they are by, its columns: the last axis of the derivatives.
        place: Place of the derivatives among the results of that function.
        has_results: Whether the results that are differentiated stand before them.

    Example:
        Slopes("forward_dynamics_derivatives", {"x": slice(0, 2), "y": slice(2, 4), "tau": slice(4, 6)})
    """

    function: str
    columns: Mapping[str, slice]
    place: int = 0
    has_results: bool = False


def slopes(name: str, source: Source) -> tuple[Slopes, ...]:
    """Return what there is of derivatives of a function, whether it was generated or not.

    Args:
        name: Name of an output, or of a function that makes one step.
        source: Generated C of the system.

    Raises:
        OptionError: If the code fills only a part of the mass matrix.

    Example:
        slopes("inverse_dynamics", library.source)   # of inverse_dynamics_derivatives and mass_matrix
    """
    if source.mass_matrix_pattern:
        raise OptionError(
            f"system {quoted(source.model.shown)}: this code fills only the lower triangle of the mass "
            'matrix, which is no matrix for derivatives. Generate it with mass_matrix="full".'
        )
    model = source.model
    sizes = len(model.coordinate_names), len(model.freedom_names), len(model.parameters)
    if name in INTEGRATORS:
        method = INTEGRATORS[name]
        if differentiates(name) or not method.has_derivatives:
            return ()
        return (Slopes(method.derivatives, _columns_of_step(*sizes), 2, has_results=True),)
    read = {array.name: array.size for function in source.functions for array in function.inputs}
    columns = {one: DERIVATIVES[one].columns(*sizes, read) for one in _derivatives(name)}
    found = [Slopes(one, own) for one, own in columns.items() if own]
    if name in _FACTORS:
        by, matrix = _FACTORS[name]
        found.append(Slopes(matrix, {by: slice(0, sizes[1])}))
    return tuple(found)


def with_derivatives(system: System, outputs: Iterable[str]) -> tuple[str, ...]:
    """Return outputs with those by which their callers are differentiated at the least cost.

    These are products with derivatives, `<output>_vjp` for gradients and `<output>_jvp` for forward mode, and
    where an output has none, whole derivatives, as far as there are any.

    Args:
        system: The tree.
        outputs: Names of outputs, and of functions that make one step.

    Example:
        >>> with_derivatives(system, ["forward_dynamics", "kinetic_energy"])[2:]
        ('forward_dynamics_vjp', 'forward_dynamics_jvp', 'kinetic_energy_derivatives')
    """
    has = available(system)
    found = dict.fromkeys(outputs)
    for name in tuple(found):
        if f"{name}_vjp" in has:
            found.update(dict.fromkeys((f"{name}_vjp", f"{name}_jvp")))
        elif name in OUTPUTS:
            matrix = _FACTORS[name][1:] if name in _FACTORS else ()
            found.update(dict.fromkeys(one for one in (*_derivatives(name), *matrix) if one in has))
        elif name in INTEGRATORS and name.startswith(STEP) and INTEGRATORS[name].has_derivatives:
            found[INTEGRATORS[name].derivatives] = None
    return tuple(found)


def require_slopes(
    name: str,
    found: Iterable[Slopes],
    wanted: Collection[str],
    generated: Container[str],
    asks: str,
    if_constant: str,
) -> None:
    """Make sure that there are derivatives of a function by some of its inputs.

    Args:
        name: Name of the function.
        found: What there is of its derivatives, generated or not.
        wanted: Names of the inputs.
        generated: Names of the functions that were generated.
        asks: Who asks for what, such as "PyTorch asks for the gradient".
        if_constant: Sentence on what to do where the result counts as constant; {} stands for an input.

    Raises:
        OptionError: If there are none, or they were not generated.
    """
    by = {column: one.function for one in found for column in one.columns}
    if missing := [one for one in wanted if one not in by]:
        if name.endswith("_derivatives"):
            program = asks.partition(" ")[0]
            raise OptionError(f"{name}: {program} asks for second derivatives, {_second_derivatives(name)}")
        known = f"There are derivatives by {', '.join(by)}." if by else "There are no derivatives of it."
        raise OptionError(f"{name}: {asks} by {', '.join(missing)}. {known} {if_constant.format(missing[0])}")
    if lacking := {by[one] for one in wanted if by[one] not in generated}:
        raise OptionError(
            f"{name}: {asks} by {', '.join(wanted)}, and the library was built without "
            f"{outputs_to_add(name, lacking)}"
        )


def outputs_to_add(name: str, lacking: Iterable[str]) -> str:
    """Return the end of a sentence on derivatives that a library lacks: which ones, and what helps.

    Args:
        name: Name of a function.
        lacking: Functions that would give its derivatives.
    """
    whole = " and ".join(sorted(lacking))
    if f"{name}_vjp" not in PRODUCTS:
        return f"{whole}. Ask for it with outputs=(...)."
    return (
        f"{name}_vjp, which gives gradients, {name}_jvp, which gives derivatives along directions, and "
        f"{whole}, which gives both at a higher cost. Ask for one with outputs=(...)."
    )


def _second_derivatives(name: str) -> str:
    """Return the end of a sentence on second derivatives that are asked for: what helps.

    Args:
        name: Name of the function that gives first derivatives, such as "forward_dynamics_derivatives".
    """
    product = f"{name.removesuffix('_derivatives').removesuffix('_input')}_hvp"
    if product in PRODUCTS:
        return f"and the library was built without {product}. Ask for it with outputs=(...)."
    return (
        "which are not generated. Use a method that needs first derivatives alone, such as BFGS or "
        "Gauss-Newton."
    )


def _derivatives(name: str) -> tuple[str, ...]:
    """Return the outputs that are derivatives of an output, by the state and by inputs from outside."""
    return tuple(one for one in (f"{name}_derivatives", f"{name}_input_derivatives") if one in DERIVATIVES)


def _columns_of_step(coordinates: int, n: int, parameters: int) -> dict[str, slice]:
    """Return the columns of the derivatives of a step, by input."""
    sizes = {"x": coordinates, "y": n, "tau": n, PARAMETERS: parameters}
    found, first = {}, 0
    for name, size in sizes.items():
        if size:
            found[name] = slice(first, first + size)
        first += size
    return found
