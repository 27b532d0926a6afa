"""Generated functions as operators of PyTorch: the call, shapes, gradients and batches."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from math import prod
from typing import Any

from kanegen.errors import OptionError
from kanegen.extras import TORCH, module
from kanegen.interop.slopes import Slopes
from kanegen.library import Library
from kanegen.model.arguments import Shape

torch = module("torch", extra=TORCH)

Tensor = Any
"""A `torch.Tensor`, or what stands for one while PyTorch compiles."""

Operator = Callable[..., Sequence[Tensor]]
"""An operator, which takes tensors in the order of `Signature.inputs` and returns a list of tensors."""

_NAMESPACE = "kanegen"
"""Namespace of the operators: `torch.ops.kanegen`."""

_NUMBERS = count()
"""Numbers that tell apart operators of libraries with one name; operators last as long as the process."""


@dataclass(frozen=True)
class Signature:
    """A generated function as PyTorch calls it.

    Attributes:
        name: Name of the function.
        inputs: Shape for one state of each tensor that it takes, by name, `parameters` last.
        outputs: Shape for one state of each result.
        dtype: Type of the numbers, a `torch.dtype`.
    """

    name: str
    inputs: Mapping[str, Shape]
    outputs: tuple[Shape, ...]
    dtype: Any

    @property
    def sizes(self) -> list[int]:
        """Numbers of one state in each result."""
        return [prod(shape) for shape in self.outputs]

    def lead(self, tensors: Sequence[Tensor]) -> Shape:
        """Return the leading dimensions to which those of some inputs broadcast."""
        shapes = zip(tensors, self.inputs.values(), strict=True)
        found: Shape = torch.broadcast_shapes(*(t.shape[: t.dim() - len(shape)] for t, shape in shapes))
        return found


def operators(
    library: Library, signatures: Mapping[str, Signature], of: Mapping[str, Sequence[Slopes]]
) -> dict[str, Operator]:
    """Return an operator for each function of a library, differentiable as far as derivatives were generated.

    Each one is registered with PyTorch, with a rule for gradients, which `torch.compile` uses. Rules that are
    registered do not work in `torch.func`; so outside of compiled code the same rule is that of a
    `torch.autograd.Function`, which works there, too.

    Args:
        library: The library.
        signatures: Its functions by name.
        of: What there is of derivatives of each function, generated or not.

    Returns:
        Functions of tensors in the order of `Signature.inputs`, by name of the function.
    """
    registered = {name: _registered(library, signature) for name, signature in signatures.items()}
    eager: dict[str, Operator] = {}
    for name, signature in signatures.items():
        rule = _Rule(signature, of[name], signatures, registered)
        torch.library.register_autograd(registered[name], rule.backward, setup_context=rule.keep)
        eager[name] = _function(registered[name], _Rule(signature, of[name], signatures, eager))
    return {name: _chosen(registered[name], eager[name]) for name in signatures}


def _chosen(compiled: Operator, eager: Operator) -> Operator:
    """Return a function that calls one operator while PyTorch compiles, and else the other."""

    def call(*tensors: Tensor) -> Sequence[Tensor]:
        return (compiled if torch.compiler.is_compiling() else eager)(*tensors)

    return call


def _registered(library: Library, signature: Signature) -> Operator:
    """Register and return the operator of a function, without gradients."""
    function = library.ufunc(signature.name)
    title = f"{_NAMESPACE}::{library.source.model.name}_{signature.name}_{next(_NUMBERS)}"
    taken = ", ".join(f"Tensor {name}" for name in signature.inputs)

    def call(*tensors: Tensor) -> list[Tensor]:
        arrays = {
            name: tensor.detach().numpy() for name, tensor in zip(signature.inputs, tensors, strict=True)
        }
        results = function(**arrays)
        several = results if isinstance(results, tuple) else (results,)
        return [torch.from_numpy(one) for one in several]

    def shapes(*tensors: Tensor) -> list[Tensor]:
        lead = signature.lead(tensors)
        return [tensors[0].new_empty((*lead, *shape)) for shape in signature.outputs]

    def in_batch(
        info: Any, places: Sequence[int | None], *tensors: Tensor
    ) -> tuple[Sequence[Tensor], list[int]]:
        return operator(*_aligned(tensors, places, signature.inputs.values())), [0] * len(signature.outputs)

    defined = torch.library.custom_op(
        title, call, mutates_args=(), device_types="cpu", schema=f"({taken}) -> Tensor[]"
    )
    defined.register_fake(shapes)
    defined.register_vmap(in_batch)
    operator: Operator = getattr(getattr(torch.ops, _NAMESPACE), title.partition("::")[2]).default
    return operator


def _aligned(
    tensors: Sequence[Tensor], places: Sequence[int | None], shapes: Iterable[Shape]
) -> list[Tensor]:
    """Return tensors some of which have a dimension of a batch, with that before all leading dimensions.

    Args:
        tensors: The tensors.
        places: Place of the dimension of the batch in each, None where it has none.
        shapes: Shape of each for one state.
    """
    moved = [
        one if place is None else one.movedim(place, 0) for one, place in zip(tensors, places, strict=True)
    ]
    axes = [
        one.dim() - len(shape) - (place is not None)
        for one, place, shape in zip(moved, places, shapes, strict=True)
    ]
    return [
        one if place is None else one.reshape(one.shape[0], *(1,) * (max(axes) - own), *one.shape[1:])
        for one, place, own in zip(moved, places, axes, strict=True)
    ]


@dataclass(frozen=True)
class _Rule:
    """The rule for gradients of an operator: derivatives of each state, times the gradients of the results.

    Attributes:
        signature: The function.
        slopes: What there is of its derivatives.
        signatures: All functions that were generated.
        every: Their operators, complete when the rule is used.
    """

    signature: Signature
    slopes: Sequence[Slopes]
    signatures: Mapping[str, Signature]
    every: Mapping[str, Operator]

    def keep(self, ctx: Any, inputs: tuple[Tensor, ...], output: Any) -> None:
        """Keep what the gradients depend on; PyTorch passes `ctx`, `inputs` and `output` by name."""
        ctx.save_for_backward(*inputs)

    def backward(self, ctx: Any, gradients: Sequence[Tensor]) -> tuple[Tensor | None, ...]:
        """Return the gradient by each input, None where it is not wanted.

        Raises:
            OptionError: If there are no derivatives by an input, or they were not generated.
        """
        signature = self.signature
        given = dict(zip(signature.inputs, ctx.saved_tensors, strict=True))
        flags = ctx.needs_input_grad[: len(given)]  # PyTorch may add one for arguments of its own
        wanted = [name for name, is_wanted in zip(given, flags, strict=True) if is_wanted]
        _require_slopes(signature, wanted, self.slopes, self.signatures)
        lead = signature.lead(ctx.saved_tensors)
        rows = [one.reshape(*lead, size) for one, size in zip(gradients, signature.sizes, strict=True)]
        along = torch.cat(rows, -1)
        found: dict[str, Tensor] = {}
        for one in self.slopes:
            own = {name: columns for name, columns in one.columns.items() if name in wanted}
            if own:
                operands = [given[name] for name in self.signatures[one.function].inputs]
                matrix = self.every[one.function](*operands)[one.place]
                axes = matrix.dim() - len(self.signatures[one.function].outputs[one.place])
                height, size = along.shape[-1], prod(matrix.shape[axes:])
                matrix = matrix.reshape(*matrix.shape[:axes], height, size // height)
                change = torch.einsum("...rk,...r->...k", matrix, along)
                for name, columns in own.items():
                    shaped = change[..., columns].reshape(*lead, *signature.inputs[name])
                    found[name] = shaped.sum_to_size(given[name].shape)
        return tuple(map(found.get, given))


def _function(operator: Operator, rule: _Rule) -> Operator:
    """Return the function of an operator and a rule, which PyTorch also differentiates in `torch.func`."""
    signature = rule.signature

    base: Any = torch.autograd.Function

    class Differentiable(base):  # type: ignore[misc]
        """The operator with the rule for its gradients."""

        setup_context = staticmethod(rule.keep)

        @staticmethod
        def forward(*tensors: Tensor) -> tuple[Tensor, ...]:
            """Return the results of the operator as a tuple."""
            return tuple(operator(*tensors))

        @staticmethod
        def backward(ctx: Any, *gradients: Tensor) -> Any:
            """Return the gradient by each input, as `_Rule.backward`."""
            return rule.backward(ctx, gradients)

        @staticmethod
        def vmap(info: Any, places: Any, *tensors: Tensor) -> tuple[Sequence[Tensor], tuple[int, ...]]:
            """Return the results for a batch, and the places of its dimension."""
            aligned = _aligned(tensors, places, signature.inputs.values())
            return Differentiable.apply(*aligned), (0,) * len(signature.outputs)

    found: Operator = Differentiable.apply
    return found


def _require_slopes(
    signature: Signature,
    wanted: Sequence[str],
    slopes: Sequence[Slopes],
    signatures: Mapping[str, Signature],
) -> None:
    """Make sure that there are derivatives of a function by some of its inputs.

    Raises:
        OptionError: If there are none, or they were not generated.
    """
    name = signature.name
    by = {column: one.function for one in slopes for column in one.columns}
    if missing := [one for one in wanted if one not in by]:
        if name.endswith("_derivatives"):
            raise OptionError(
                f"{name}: PyTorch asks for second derivatives, which are not generated. Use a method that "
                "needs first derivatives alone."
            )
        known = f"There are derivatives by {', '.join(by)}." if by else "There are no derivatives of it."
        raise OptionError(
            f"{name}: PyTorch asks for the gradient by {', '.join(missing)}. {known} Detach what is constant."
        )
    lacking = [function for one in wanted if (function := by[one]) not in signatures]
    if lacking:
        raise OptionError(
            f"{name}: PyTorch asks for the gradient by {', '.join(wanted)}, and the library was built "
            f"without {', '.join(dict.fromkeys(lacking))}. Ask for it with outputs=(...)."
        )
