"""Functions as PyTorch calls them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

from kanegen.extras import TORCH, module
from kanegen.model.arguments import Shape

torch = module("torch", extra=TORCH)

Tensor = Any
"""A `torch.Tensor`, or what stands for one while PyTorch compiles."""

Operator = Callable[..., Sequence[Tensor]]
"""An operator, which takes tensors in the order of `Signature.inputs` and returns a list of tensors."""


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
