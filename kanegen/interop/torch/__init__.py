"""PyTorch: generated functions as operators of PyTorch, with gradients.

`functions` makes them of a system. They run on the CPU, broadcast leading dimensions, and have rules for
gradients, `torch.func.vmap` and `torch.compile`. PyTorch itself comes with the extra `torch` and is imported
with this package.

Example:
    import kanegen as kg
    import kanegen.interop.torch

    panda = kanegen.interop.torch.functions(kg.load("models/panda_arm.toml"))
    ydot = panda.forward_dynamics(x, y, tau)
"""

from __future__ import annotations

from kanegen.interop.torch.functions import Functions, functions

__all__ = ["Functions", "functions"]
