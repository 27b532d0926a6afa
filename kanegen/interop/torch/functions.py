"""`functions`: the functions of a system as operators of PyTorch."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from kanegen.choices import did_you_mean, flag
from kanegen.compiler import generate
from kanegen.errors import ArrayError, ModelError, OptionError, quoted
from kanegen.extras import TORCH, module
from kanegen.interop.arguments import ArgumentNames
from kanegen.interop.products import products_of
from kanegen.interop.slopes import slopes, with_derivatives
from kanegen.interop.torch.operators import operators
from kanegen.interop.torch.signature import Operator, Signature, Tensor
from kanegen.library import Library, load
from kanegen.library.native.status import OnStatus
from kanegen.model.arguments import MODEL_DEPENDENT, OPTIONAL, STEP, required
from kanegen.model.system import System
from kanegen.options import STRICT, Variant
from kanegen.program.ir import PARAMETERS
from kanegen.recursion.outputs import INTEGRATORS, OUTPUTS, RATES, chosen
from kanegen.recursion.outputs.integrators import ROLLOUT

torch = module("torch", extra=TORCH)

_TYPES = {"double": torch.float64, "float": torch.float32}
"""Types of PyTorch for the numbers of a library."""


def functions(
    model: System | Library,
    outputs: Iterable[str] | str = RATES[:1],
    *,
    derivatives: bool = True,
    precision: str | None = None,
    tier: Variant | str = STRICT,
    compiler: str | None = None,
    flags: str | Sequence[str] | None = None,
    threads: bool = False,
    on_status: OnStatus = "warn",
) -> Functions:
    """Return functions of a system for PyTorch, compiled to C that runs on the CPU.

    Args:
        model: The tree of bodies. Or a library, whose functions, parameters and `on_status` are taken.
        outputs: Names of outputs, and of functions that make one step, such as "step_rk4".
        derivatives: Whether to generate what first derivatives of these outputs need, too, as far as there
            is any: `<output>_vjp` and `<output>_jvp` of outputs that have them, else `<output>_derivatives`.
            Second derivatives need `<output>_hvp` among the outputs.
        precision: Arithmetic of the C: "double" for tensors of float64, "float" for float32.
        tier: All other choices between speed and accuracy, as in `kanegen.generate`.
        compiler: Command of a C compiler, by default the first that is found.
        flags: Compiler flags in place of those of the variant.
        threads: Whether OpenMP shares large batches among threads.
        on_status: What happens where a result is missing, not finite or not accurate, as in
            `Library.with_on_status`.

    Raises:
        OptionError: If an output or a choice does not exist or does not fit, or PyTorch has no numbers of the
            precision.
        MissingError: If PyTorch is not installed.
        ModelError, SingularError: As `kanegen.generate`.
        BuildError: If there is no compiler, or it fails.

    Example:
        system = kg.load("models/panda_arm.toml")
        arm = kanegen.interop.torch.functions(system, ("forward_dynamics", "step_rk4"))
        ydot = arm.forward_dynamics(x, y, tau)
        x, y = arm.step_rk4(x, y, tau, step=1e-3)
    """
    if isinstance(model, Library):
        return Functions(model)
    if not isinstance(model, System):
        raise OptionError(
            f"functions: {quoted(model)} is no system and no library. Give what kg.load returns."
        )
    asked = chosen(outputs, INTEGRATORS)
    for name in asked:
        if name.startswith(ROLLOUT):
            raise OptionError(
                f"output {quoted(name)}: PyTorch follows motions by steps, which it can differentiate. Take "
                f"{INTEGRATORS[name].functions[0]}."
            )
    every = with_derivatives(model, asked) if flag("derivatives", derivatives) else asked
    source = generate(
        model,
        every,
        precision=precision,
        tier=tier,
        functions=every,
        parameters_by_state=bool(model.parameters),
    )
    return Functions(load(source, compiler, flags, threads, on_status))


class Function:
    """A function of a compiled model for PyTorch.

    It takes the arguments of the method of `Library` of the same name: tensors of the library's numbers on
    the CPU with any strides, or what `torch.as_tensor` takes. Their leading dimensions broadcast. It may be
    differentiated by the arguments of which there are derivatives, twice if `<output>_hvp` was built, mapped
    by `torch.func.vmap` and
    compiled by `torch.compile`.

    Example:
        ydot = arm.forward_dynamics(x, y, tau)
        ydot.sum().backward()
    """

    def __init__(self, signature: Signature, operator: Operator, library: Library) -> None:
        """Keep the operator, and the library for the values of its parameters."""
        self._signature, self._operator = signature, operator
        self._usual = dict(library.parameters)
        self._names = ArgumentNames.of(signature.name, library, tuple(signature.inputs))

    def __repr__(self) -> str:
        shapes = self._signature.inputs.items()
        arguments = ", ".join(f"{name} ({', '.join(['...', *map(str, shape)])})" for name, shape in shapes)
        return f"<Function {self._signature.name} for PyTorch: {arguments}>"

    def __call__(self, *values: Any, **named: Any) -> Tensor | tuple[Tensor, ...]:
        """Return the result, or a tuple of the results, each (*lead, *shape of one state).

        Args:
            values: Arguments in the order of the method of `Library`; None stands for no load.
            named: Arguments by name. `parameters` are (*lead, P) run-time parameters in place of those of the
                library, or tensors of some of them by name.

        Raises:
            ArrayError: If an argument has the wrong shape, type or device, is missing, or does not exist.
            ModelError: If there is no parameter of a name.
            StatusError: See `Library.with_on_status`.
        """
        given = self._names.bound(values, named)
        tensors = [self._tensor(name, given.get(name)) for name in self._signature.inputs]
        results = self._operator(*tensors)
        return results[0] if len(results) == 1 else tuple(results)

    def _tensor(self, name: str, value: Any) -> Tensor:
        """Return an argument as a tensor of the library's numbers, (*lead, *shape of one state)."""
        shape, dtype = self._signature.inputs[name], self._signature.dtype
        if name == PARAMETERS and not isinstance(value, torch.Tensor):
            value = self._parameters(value)
        if value is None and name in OPTIONAL:
            return torch.zeros(shape, dtype=dtype)
        if value is None:
            meaning = (MODEL_DEPENDENT | STEP).get(name, f"shape {shape}")
            words = {"count": shape[-1] if shape else 1, "prescribed": "the prescribed freedoms"}
            required(name, value, meaning.format(**words))
        if not isinstance(value, torch.Tensor) or not value.is_floating_point():
            value = _numbers(name, value, dtype)
        if value.dtype != dtype:
            other = '"float"' if value.dtype == torch.float32 else '"double"'
            raise ArrayError(
                f"{name}: expected numbers of {dtype}, got {value.dtype}. Convert it with .to({dtype}), or "
                f"take functions with precision={other}."
            )
        if value.device.type != "cpu":
            raise ArrayError(f"{name}: it is on {value.device}. The C runs on the CPU: move it with .cpu().")
        before = value.dim() - len(shape)
        if before < 0 or tuple(value.shape[before:]) != shape:
            wanted = ", ".join(["...", *map(str, shape)])
            raise ArrayError(f"{name}: expected shape ({wanted}), got {tuple(value.shape)}.")
        return value

    def _parameters(self, value: Any) -> Any:
        """Return the run-time parameters: those of the library, or values by name with the others of it.

        Raises:
            ModelError: If there is no parameter of a name.
        """
        dtype = self._signature.dtype
        if value is None:
            return torch.tensor([*self._usual.values()], dtype=dtype)
        if not isinstance(value, Mapping):
            return _numbers(PARAMETERS, value, dtype)
        for name in value:
            if name not in self._usual:
                raise ModelError(f"unknown parameter {quoted(name)}. {did_you_mean(name, self._usual)}")
        columns = [_numbers(one, value.get(one, usual), dtype) for one, usual in self._usual.items()]
        return torch.stack(torch.broadcast_tensors(*columns), dim=-1)


def _numbers(name: str, value: Any, dtype: Any) -> Tensor:
    """Return a value as a tensor of real numbers.

    Raises:
        ArrayError: If it holds anything else, or rows of different lengths.
    """
    try:
        found = value if isinstance(value, torch.Tensor) else torch.as_tensor(value, dtype=torch.float64)
    except (TypeError, ValueError, RuntimeError):
        raise ArrayError(
            f"{name}: expected real numbers in rows of one length, got {quoted(value)}."
        ) from None
    if found.is_complex() or found.dtype == torch.bool:
        raise ArrayError(f"{name}: expected real numbers, got {found.dtype}.")
    return found.to(dtype)


class Functions:
    """The functions of a compiled model for PyTorch: an attribute for each, of the name of its output.

    Attributes:
        library: The same functions with NumPy arrays, and all names, sizes and parameters.

    Example:
        arm = kanegen.interop.torch.functions(kg.load("models/panda_arm.toml"))
        ydot = arm.forward_dynamics(x, y, tau)
    """

    library: Library

    def __init__(self, library: Library) -> None:
        """Register the functions of a library as operators.

        Raises:
            OptionError: If PyTorch has no numbers of the precision of its arrays.
        """
        if library.storage not in _TYPES or library.precision == "double-double":
            raise OptionError(
                f"functions: the arrays of system {quoted(library.name)} are {library.storage!r}, which "
                'PyTorch does not have. Take precision="double" or "float".'
            )
        self.library = library
        there = [name for name in library.outputs if name in library.c_functions]
        names = [name for name in there if name in OUTPUTS or name in INTEGRATORS]
        signatures = {name: _signature(library, name) for name in names if not name.startswith(ROLLOUT)}
        of = {name: slopes(name, library.source) for name in signatures}
        found = operators(library, signatures, of, products_of(library.source))
        self._functions = {name: Function(signatures[name], one, library) for name, one in found.items()}

    def __repr__(self) -> str:
        return f"<Functions of {self.library.name} for PyTorch: {', '.join(self._functions)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how `pickle` makes the functions anew."""
        return type(self), (self.library,)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._functions]

    def __getattr__(self, name: str) -> Function:
        """Return the function of an output.

        Raises:
            AttributeError: If it was not built.
        """
        if name.startswith("_"):  # also while `pickle` and `copy` make an object that has no functions yet
            raise AttributeError(name)
        if name in self._functions:
            return self._functions[name]
        if name in OUTPUTS or name in INTEGRATORS:
            raise AttributeError(
                f"system {quoted(self.library.name)} was built without the output {quoted(name)}. It has "
                f"{', '.join(self._functions)}; ask for more with outputs=(...)."
            )
        raise AttributeError(f"there is no output {quoted(name)}. {did_you_mean(name, self._functions)}")


def _signature(library: Library, name: str) -> Signature:
    """Return a function of a library as PyTorch calls it."""
    inputs, outputs = library.ufunc(name).shapes
    parameters = {PARAMETERS: (len(library.parameters),)} if library.parameters else {}
    return Signature(name, {**inputs, **parameters}, tuple(outputs.values()), _TYPES[library.storage])
