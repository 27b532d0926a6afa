"""JAX: generated functions as functions of JAX, which compiles, batches and differentiates what calls them.

`functions` makes them of a system. XLA, the compiler of JAX, calls the generated C through its foreign
function interface, on the CPU; their derivatives are generated outputs, too. JAX itself comes with the extra
`jax` and is imported with this package.

Example:
    import kanegen as kg
    import kanegen.interop.jax

    jax.config.update("jax_enable_x64", True)
    panda = kanegen.interop.jax.functions(kg.load("models/panda_arm.toml"))
    ydot = panda.forward_dynamics(x, y, tau)
"""

from __future__ import annotations

from kanegen.interop.jax.functions import Functions, functions

__all__ = ["Functions", "functions"]
