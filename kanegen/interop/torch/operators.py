"""Generated functions as operators of PyTorch: the call, shapes, derivatives and batches."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import count
from typing import Any

from kanegen.extras import TORCH, module
from kanegen.interop.products import CURVATURE, ENDINGS, HESSIAN, Form, Products
from kanegen.interop.slopes import Slopes
from kanegen.interop.torch.products import ProductFunction
from kanegen.interop.torch.rules import JacobianRule, ProductRule, Rule, keep, keep_for_both
from kanegen.interop.torch.signature import Operator, Signature, Tensor
from kanegen.library import Library
from kanegen.model.arguments import OF_PRODUCTS, Shape

torch = module("torch", extra=TORCH)

_NAMESPACE = "kanegen"
"""Namespace of the operators: `torch.ops.kanegen`."""

_NUMBERS = count()
"""Numbers that tell apart operators of libraries with one name; operators last as long as the process."""


def operators(
    library: Library,
    signatures: Mapping[str, Signature],
    of: Mapping[str, Sequence[Slopes]],
    products: Mapping[str, tuple[Products, Form]],
) -> dict[str, Operator]:
    """Return an operator for each function of a library, differentiable as far as derivatives were generated.

    Each one is registered with PyTorch, with a rule for gradients, which `torch.compile` uses. Rules that are
    registered do not work in `torch.func`; so outside of compiled code the same rule is that of a
    `torch.autograd.Function`, which works there, too.

    Args:
        library: The library.
        signatures: Its functions by name.
        of: What there is of derivatives of each function, generated or not.
        products: Products with derivatives that were generated, by name of the function, with its own form.

    Returns:
        Functions of tensors in the order of `Signature.inputs`, by name of the function.
    """
    prefix = library.source.model.name
    compiled: dict[str, Operator] = {}
    eager: dict[str, Operator] = {}
    linear = {
        one: _product_operators(library, one, *_inputs(signatures, one))
        for one in dict.fromkeys(one for one, _ in products.values())
    }
    for name, signature in signatures.items():
        registered = _registered(f"{prefix}_{name}", signature, library.ufunc(name))
        if name in products:
            one, form = products[name]
            rules: Sequence[Rule] = [ProductRule(signature, form, one, every) for every in linear[one]]
        else:
            rules = [JacobianRule(signature, of[name], signatures, every) for every in (compiled, eager)]
        compiled[name], eager[name] = _differentiable(registered, signature, *rules)
    return {name: _chosen(compiled[name], eager[name]) for name in signatures}


def _product_operators(
    library: Library, products: Products, inputs: Mapping[str, Shape], dtype: Any
) -> tuple[dict[Form, Operator], dict[Form, Operator]]:
    """Return operators of the products with derivatives of an output, for compiled code and outside of it.

    Args:
        library: The library.
        products: Which there are.
        inputs: Shape for one state of each input of the output.
        dtype: Type of the numbers, a `torch.dtype`.
    """
    compiled: dict[Form, Operator] = {}
    eager: dict[Form, Operator] = {}
    there = [one for one in ENDINGS if one in products.functions or products.takes_jacobian(one, 1)]
    for form in (*there, *((CURVATURE,) if HESSIAN in there else ())):
        function = ProductFunction(library, products, form, inputs)
        signature = function.signature(dtype)
        registered = _registered(f"{library.source.model.name}_{signature.name}", signature, function)
        rules: Sequence[Rule] = [ProductRule(signature, form, products, one) for one in (compiled, eager)]
        compiled[form], eager[form] = _differentiable(registered, signature, *rules)
    return compiled, eager


def _inputs(signatures: Mapping[str, Signature], products: Products) -> tuple[dict[str, Shape], Any]:
    """Return the shape for one state of each input of an output, by name, and the type of its numbers."""
    one = signatures[next(iter(products.functions.values()))]
    return {name: shape for name, shape in one.inputs.items() if name not in OF_PRODUCTS}, one.dtype


def _differentiable(
    registered: Operator, signature: Signature, compiled: Rule, eager: Rule
) -> tuple[Operator, Operator]:
    """Return an operator with a rule for compiled code, and one with a rule for code outside of it."""
    torch.library.register_autograd(registered, compiled.backward, setup_context=keep)
    return registered, _function(registered, signature, eager)


def _chosen(compiled: Operator, eager: Operator) -> Operator:
    """Return a function that calls one operator while PyTorch compiles, and else the other."""

    def call(*tensors: Tensor) -> Sequence[Tensor]:
        return (compiled if torch.compiler.is_compiling() else eager)(*tensors)

    return call


def _registered(name: str, signature: Signature, function: Callable[..., Any]) -> Operator:
    """Register and return the operator of a function of arrays, without gradients.

    Args:
        name: Its name, to which a number is added.
        signature: The function as PyTorch calls it.
        function: The function, which takes arrays by name.
    """
    title = f"{_NAMESPACE}::{name}_{next(_NUMBERS)}"
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


def _function(operator: Operator, signature: Signature, rule: Rule) -> Operator:
    """Return the function of an operator and a rule, which PyTorch also differentiates in `torch.func`."""
    base: Any = torch.autograd.Function

    class Differentiable(base):  # type: ignore[misc]
        """The operator with the rule for its derivatives."""

        setup_context = staticmethod(keep_for_both)

        @staticmethod
        def forward(*tensors: Tensor) -> tuple[Tensor, ...]:
            """Return the results of the operator as a tuple."""
            return tuple(operator(*tensors))

        @staticmethod
        def backward(ctx: Any, *gradients: Tensor) -> Any:
            """Return the gradient by each input, as `Rule.backward`."""
            return rule.backward(ctx, gradients)

        @staticmethod
        def jvp(ctx: Any, *directions: Tensor | None) -> Any:
            """Return the change of each result along a direction, as `Rule.along`."""
            return rule.along(ctx, directions)

        @staticmethod
        def vmap(info: Any, places: Any, *tensors: Tensor) -> tuple[Sequence[Tensor], tuple[int, ...]]:
            """Return the results for a batch, and the places of its dimension."""
            aligned = _aligned(tensors, places, signature.inputs.values())
            return Differentiable.apply(*aligned), (0,) * len(signature.outputs)

    found: Operator = Differentiable.apply
    return found
