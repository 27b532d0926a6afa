"""`functions`: the functions of a system as functions of JAX."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from kanegen.c import Source
from kanegen.choices import did_you_mean, flag, require_one
from kanegen.compiler import generate
from kanegen.errors import OptionError, quoted
from kanegen.interop.jax.calls import RULES
from kanegen.interop.jax.cuda import kernels
from kanegen.interop.jax.facade import require_numbers
from kanegen.interop.jax.function import Function, functions_by_name
from kanegen.interop.jax.handlers import handlers
from kanegen.interop.jax.motions import Motions
from kanegen.interop.slopes import with_derivatives
from kanegen.library import Library
from kanegen.library.native.build import Recipe
from kanegen.model.system import System
from kanegen.options import STRICT, Variant, chosen_variant
from kanegen.recursion.outputs import INTEGRATORS, OUTPUTS, RATES
from kanegen.recursion.outputs import chosen as chosen_outputs
from kanegen.recursion.outputs.integrators import STEP

DEVICES = ("cpu", "cuda")
"""Where JAX can call functions."""


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
    on_status: str | None = None,
    device: str = "cpu",
    nvcc: str = "nvcc",
) -> Functions:
    """Return functions of a system for JAX, compiled to C that XLA calls on the CPU, or to kernels for GPUs.

    Args:
        model: The tree of bodies. Or a library, whose outputs and choices are taken; it is compiled once
            more, together with its handlers for XLA.
        outputs: Names of outputs, and of functions that make one step, such as "step_rk4".
        derivatives: Whether to generate what first derivatives of these outputs need, too, as far as there
            is any: `<output>_vjp` and `<output>_jvp` of outputs that have them, else `<output>_derivatives`.
            Second derivatives need `<output>_hvp` among the outputs.
        precision: Arithmetic of the C: "double", or "float" for numbers of 32 bits, which are all
            that JAX has by default.
        tier: All other choices between speed and accuracy, as in `kanegen.generate`.
        compiler: Command of a C compiler, by default the first that is found.
        flags: Compiler flags in place of those of the variant.
        threads: Whether OpenMP shares large batches among threads.
        on_status: What happens where a result is missing, not finite or not accurate: "warn", "raise" or
            "ignore", as in `Library.with_on_status`. What raises there lets the call of JAX fail with the
            same message. By default "warn", and "ignore" on a GPU, which does not wait for statuses.
        device: Where JAX calls the functions: "cpu", or "cuda" for GPUs of NVIDIA.
        nvcc: Command of the compiler for GPUs, with further flags if there are any.

    Raises:
        OptionError: If an output or a choice does not exist or does not fit, or JAX has no numbers of the
            precision.
        ModelError, SingularError: As `kanegen.generate`.
        BuildError: If there is no compiler, or it fails; on a GPU also nvcc.

    Example:
        system = kg.load("models/panda_arm.toml")
        arm = kanegen.interop.jax.functions(system, ("forward_dynamics", "step_rk4"))
        ydot = arm.forward_dynamics(x, y, tau)
        x, y = arm.step(x, y, tau, step=1e-3)
    """
    require_one("device", device, DEVICES)
    on_status = _on_status(on_status, device)
    if isinstance(model, Library):
        return Functions(model.recipe, model.parameters, on_status, device, nvcc)
    if not isinstance(model, System):
        raise OptionError(
            f"functions: {quoted(model)} is no system and no library. Give what kg.load returns."
        )
    require_numbers(model.name, chosen_variant(tier, precision=precision))
    asked = _asked(model, outputs)
    every = with_derivatives(model, asked) if flag("derivatives", derivatives) else asked
    source = generate(
        model,
        every,
        precision=precision,
        tier=tier,
        functions=every,
        parameters_by_state=bool(model.parameters),
    )
    recipe = Recipe.of(source, compiler, flags, threads)
    return Functions(recipe, dict(source.model.parameters), on_status, device, nvcc)


def _on_status(on_status: str | None, device: str) -> str:
    """Return the rule for statuses, checked.

    Raises:
        OptionError: If there is no such rule, or none on a GPU.
    """
    if on_status is None:
        return "warn" if device == "cpu" else "ignore"
    require_one("on_status", on_status, RULES)
    if device != "cpu" and on_status != "ignore":
        raise OptionError(
            f"on_status {quoted(on_status)}: a GPU does not wait for statuses; results that do not exist are "
            "NaN. Leave it out, or take 'ignore'."
        )
    return on_status


def _asked(system: System, outputs: Iterable[str] | str) -> tuple[str, ...]:
    """Return the checked names of outputs and steps, with what `Functions.state_rates` needs.

    Raises:
        OptionError: If there is no such name, or it is that of a rollout.
    """
    asked = chosen_outputs(outputs, INTEGRATORS)
    for name in asked:
        if name in INTEGRATORS and not name.startswith(STEP):
            raise OptionError(
                f"output {quoted(name)}: JAX follows motions by steps, which it can differentiate. Take "
                f"{INTEGRATORS[name].functions[0]}, and call rollout."
            )
    needs_rates = RATES[0] in asked and not system.speeds_are_rates
    return tuple(dict.fromkeys((*asked, *(RATES if needs_rates else ()))))


def _require_batches(source: Source) -> None:
    """Make sure that a source has functions for many states, each with its own parameters.

    Raises:
        OptionError: If it has not.
    """
    system = quoted(source.model.shown)
    if not source.has_batches:
        raise OptionError(
            f"functions: system {system} was built without functions for many states. Build it with "
            "batches=True."
        )
    if source.model.parameters and not source.parameters_by_state:
        raise OptionError(
            f"functions: system {system} was built with one set of parameters for all states of a batch. "
            "Build it with parameters_by_state=True."
        )


class Functions(Motions):
    """The functions of a compiled model for JAX: an attribute for each, of the name of its output.

    They have the arguments of the methods of `Library` with the same names, with any number of leading axes,
    and may be compiled, batched and differentiated: `jax.jit`, `jax.vmap`, `jax.grad`, `jax.jacfwd`,
    `jax.lax.scan`. Gradients have derivatives themselves if the output `<output>_hvp` was built.

    A function with a missing result, such as accelerations where [A] is singular, gives NaN there and a
    warning or an error, see `functions`. Threads may share a `Functions`, and it can be pickled.

    Example:
        arm = kanegen.interop.jax.functions(kg.load("models/panda_arm.toml"))
        work = jax.grad(lambda tau: arm.forward_dynamics(x, y, tau).sum())
    """

    def __init__(
        self,
        recipe: Recipe,
        parameters: Mapping[str, float],
        on_status: str = "warn",
        device: str = "cpu",
        nvcc: str = "nvcc",
    ) -> None:
        """Compile the functions with their handlers, or find them in the cache, and tell JAX of them.

        Args:
            recipe: What is compiled and how.
            parameters: Values of the run-time parameters where a call names no others.
            on_status: What happens where a result is missing, not finite or not accurate.
            device: Where JAX calls the functions, "cpu" or "cuda".
            nvcc: Command of the compiler for GPUs.

        Raises:
            OptionError: If JAX has no numbers of the precision, or the source has one set of parameters for
                all states.
            BuildError: If there is no compiler, or it fails.
        """
        require_numbers(recipe.source.model.shown, recipe.source.variant)
        _require_batches(recipe.source)
        on_gpu = device == "cuda"
        found = kernels(recipe, parameters, nvcc) if on_gpu else handlers(recipe, parameters, on_status)
        self.library = found.library
        self._arguments = recipe, dict(parameters), on_status, device, nvcc
        self._functions = functions_by_name(found)

    def __repr__(self) -> str:
        return f"<Functions of {self.library.name} for JAX: {', '.join(self._functions)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how `pickle` makes the functions anew: from the source, or the cache."""
        return type(self), self._arguments

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._functions]

    def __getattr__(self, name: str) -> Function:
        """Return the function of an output.

        Raises:
            AttributeError: If it was not built.
        """
        if name.startswith("_"):  # also while `pickle` and `copy` make an object that has no functions yet
            raise AttributeError(name)
        try:
            return self._functions[name]
        except KeyError:
            raise AttributeError(self._absence(name)) from None

    def _function(self, name: str) -> Function:
        """Return the function of an output, as `Motions._function`."""
        if name not in self._functions:
            raise OptionError(self._absence(name))
        return self._functions[name]

    def _absence(self, name: str) -> str:
        """Return the sentences that say that there is no function of a name."""
        known = ", ".join(self._functions)
        if name in OUTPUTS or name in INTEGRATORS:
            system = quoted(self.library.name)
            return (
                f"system {system} was built without the output {quoted(name)}. It has {known}; ask for more "
                "with outputs=(...)."
            )
        return f"there is no output {quoted(name)}. {did_you_mean(name, self._functions)}"
