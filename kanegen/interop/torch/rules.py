"""Rules by which PyTorch differentiates operators: by whole Jacobians, or by products without these."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any, Protocol

from kanegen.extras import TORCH, module
from kanegen.interop.products import Form, Products
from kanegen.interop.slopes import Slopes, require_slopes
from kanegen.interop.torch.signature import Operator, Signature, Tensor

torch = module("torch", extra=TORCH)


class Rule(Protocol):
    """How PyTorch differentiates an operator."""

    def backward(self, ctx: Any, gradients: Sequence[Tensor | None]) -> tuple[Tensor | None, ...]:
        """Return the gradient by each input, None where it is not wanted, of results with gradients."""

    def along(self, ctx: Any, directions: Sequence[Tensor | None]) -> tuple[Tensor, ...]:
        """Return the change of each result along a direction of the inputs, None for those that stay."""


def keep(ctx: Any, inputs: tuple[Tensor, ...], output: Any) -> None:
    """Keep what derivatives depend on; PyTorch passes `ctx`, `inputs` and `output` by name."""
    ctx.save_for_backward(*inputs)


def keep_for_both(ctx: Any, inputs: tuple[Tensor, ...], output: Any) -> None:
    """Keep what derivatives in both modes depend on; what does not move is None then, and no zeros."""
    ctx.set_materialize_grads(False)
    ctx.save_for_backward(*inputs)
    ctx.save_for_forward(*inputs)


@dataclass(frozen=True)
class JacobianRule:
    """Derivatives of an operator by those of each state, times gradients of the results or directions.

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

    def backward(self, ctx: Any, gradients: Sequence[Tensor | None]) -> tuple[Tensor | None, ...]:
        """Return the gradient by each input, None where it is not wanted, of results with gradients.

        Raises:
            OptionError: If there are no derivatives by an input, or they were not generated.
        """
        signature = self.signature
        given = dict(zip(signature.inputs, ctx.saved_tensors, strict=True))
        lead = signature.lead(ctx.saved_tensors)
        zero = ctx.saved_tensors[0].new_zeros(())
        rows = [
            zero.expand(*lead, size) if one is None else one.reshape(*lead, size)
            for one, size in zip(gradients, signature.sizes, strict=True)
        ]
        weights = torch.cat(rows, -1)
        found: dict[str, Tensor] = {}
        for matrix, columns in self._jacobians(given, _wanted(ctx, given)):
            change = torch.einsum("...rk,...r->...k", matrix, weights)
            for name, own in columns.items():
                shaped = change[..., own].reshape(*lead, *signature.inputs[name])
                found[name] = shaped.sum_to_size(given[name].shape)
        return tuple(map(found.get, given))

    def along(self, ctx: Any, directions: Sequence[Tensor | None]) -> tuple[Tensor, ...]:
        """Return the change of each result along a direction of the inputs, None for those that stay.

        Raises:
            OptionError: If there are no derivatives by an input, or they were not generated.
        """
        signature = self.signature
        given = dict(zip(signature.inputs, ctx.saved_tensors, strict=True))
        moved = {n: one for n, one in zip(given, directions, strict=True) if one is not None}
        lead, sizes = signature.lead(ctx.saved_tensors), signature.sizes
        change = ctx.saved_tensors[0].new_zeros((*lead, sum(sizes)))
        for matrix, columns in self._jacobians(given, [*moved]):
            for name, own in columns.items():
                flat = moved[name].reshape(*_lead(moved[name], signature.inputs[name]), own.stop - own.start)
                change = change + torch.einsum("...rk,...k->...r", matrix[..., own], flat)
        parts = zip(change.split(sizes, -1), signature.outputs, strict=True)
        return tuple(one.reshape(*lead, *shape) for one, shape in parts)

    def _jacobians(
        self, given: Mapping[str, Tensor], wanted: Sequence[str]
    ) -> Iterator[tuple[Tensor, dict[str, slice]]]:
        """Yield derivatives, (*lead, rows, K), with the columns by each of the inputs that are wanted.

        Raises:
            OptionError: If there are none by an input, or they were not generated.
        """
        asks = self.signature.name, self.slopes, wanted, self.signatures, "PyTorch asks for the gradient"
        require_slopes(*asks, "Detach what is constant.")
        height = sum(self.signature.sizes)
        for one in self.slopes:
            own = {name: columns for name, columns in one.columns.items() if name in wanted}
            if own:
                signature = self.signatures[one.function]
                matrix = self.every[one.function](*map(given.get, signature.inputs))[one.place]
                shape = signature.outputs[one.place]
                yield matrix.reshape(*_lead(matrix, shape), height, prod(shape) // height), own


@dataclass(frozen=True)
class ProductRule:
    """Derivatives of an output or of a product with its derivatives by other products.

    Attributes:
        signature: The function.
        form: Which product it is, or `VALUE`.
        products: Products with derivatives of the output that were generated.
        every: The operator of each product, of the inputs of the output and then the vectors.
    """

    signature: Signature
    form: Form
    products: Products
    every: Mapping[Form, Operator]

    def backward(self, ctx: Any, gradients: Sequence[Tensor | None]) -> tuple[Tensor | None, ...]:
        """Return the gradient by each input, None where it is not wanted, of results with gradients.

        Raises:
            OptionError: If a product that is needed was not generated.
        """
        given, vectors = self._parts(ctx.saved_tensors)
        every = {**given, **vectors}
        wanted = _wanted(ctx, self.signature.inputs)
        along, (weights,) = tuple(vectors.values()), gradients
        if weights is None:
            return (None,) * len(self.signature.inputs)
        found: dict[str, Tensor] = {}
        if variables := [name for name in wanted if name in given]:
            change = self._product(given, *self.form.by_variables(along, weights))
            for name in variables:
                shape = (*change.shape[:-1], *self.signature.inputs[name])
                found[name] = change[..., self.products.columns[name]].reshape(shape)
        for place, name in enumerate(vectors):
            if name in wanted:
                found[name] = self._product(given, *self.form.by_vector(place, along, weights))
        shaped = {name: one.sum_to_size(every[name].shape) for name, one in found.items()}
        return tuple(map(shaped.get, self.signature.inputs))

    def along(self, ctx: Any, directions: Sequence[Tensor | None]) -> tuple[Tensor, ...]:
        """Return the change of the result along a direction of the inputs, None for those that stay.

        Raises:
            OptionError: If a product that is needed was not generated.
        """
        given, vectors = self._parts(ctx.saved_tensors)
        named = zip(self.signature.inputs, directions, strict=True)
        moved = {name: one for name, one in named if one is not None}
        own = tuple(vectors.values())
        lead = self.signature.lead(ctx.saved_tensors)
        changes: list[Tensor] = []
        if any(name in moved for name in given):
            changes.append(
                self._product(given, self.form.along(), (*own, self._direction(given, moved, lead)))
            )
        for place, name in enumerate(vectors):
            if name in moved:
                changes.append(
                    self._product(given, self.form, (*own[:place], moved[name], *own[place + 1 :]))
                )
        total: Tensor = sum(changes[1:], changes[0])
        return (total.expand(*lead, *self.signature.outputs[0]),)

    def _parts(self, tensors: Sequence[Tensor]) -> tuple[dict[str, Tensor], dict[str, Tensor]]:
        """Return the inputs of the output and the vectors, each by name."""
        named = dict(zip(self.signature.inputs, tensors, strict=True))
        columns = self.products.columns
        return (
            {name: one for name, one in named.items() if name in columns},
            {name: one for name, one in named.items() if name not in columns},
        )

    def _product(self, given: Mapping[str, Tensor], form: Form, vectors: Sequence[Tensor]) -> Tensor:
        """Return a product with derivatives, (*lead, elements).

        Raises:
            OptionError: If it was not generated.
        """
        self.products.require(form, "PyTorch")
        return self.every[form](*given.values(), *vectors)[0]

    def _direction(
        self, given: Mapping[str, Tensor], moved: Mapping[str, Tensor], lead: Sequence[int]
    ) -> Tensor:
        """Return a direction of all variables, (*lead, K), of which some move."""
        parts = []
        for name, own in self.products.columns.items():
            size = own.stop - own.start
            if name in moved:
                flat = moved[name].reshape(*_lead(moved[name], self.signature.inputs[name]), size)
                parts.append(flat.expand(*lead, size))
            else:
                parts.append(next(iter(given.values())).new_zeros((*lead, size)))
        return torch.cat(parts, -1)


def _wanted(ctx: Any, names: Sequence[str] | Mapping[str, Any]) -> list[str]:
    """Return the names of the inputs by which gradients are wanted."""
    flags = ctx.needs_input_grad[: len(names)]  # PyTorch may add one for arguments of its own
    return [name for name, is_wanted in zip(names, flags, strict=True) if is_wanted]


def _lead(tensor: Tensor, shape: Sequence[int]) -> Sequence[int]:
    """Return the leading dimensions of a tensor, before the shape of one state."""
    found: Sequence[int] = tensor.shape[: tensor.dim() - len(shape)]
    return found
