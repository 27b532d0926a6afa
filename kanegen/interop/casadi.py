"""CasADi: the outputs of a system as functions of CasADi, compiled or as expressions.

`function` compiles the generated code with the artifact "casadi" into a shared library and loads a function
from it by `casadi.external`; its Jacobian is exact. `expression` writes the same instructions as expressions
of CasADi, which has all derivatives of them. Either can stand in other expressions, in problems of `nlpsol`
and `Opti`, in `integrator`, and in C that CasADi generates.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from kanegen import extras
from kanegen.artifacts import ARTIFACTS
from kanegen.artifacts.casadi import (
    ODE,
    CasadiFunction,
    casadi,
    casadi_functions,
    derivatives,
    file_name,
    other_numbers,
    symbol,
)
from kanegen.c.source import Source
from kanegen.choices import require_one
from kanegen.compiler import generate
from kanegen.errors import OptionError, quoted
from kanegen.interop.casadi_expressions import expressions
from kanegen.interop.products import ALONG, GRADIENT, products_of
from kanegen.library.library import Library
from kanegen.library.native.build import build
from kanegen.library.native.facade import Facade
from kanegen.model.system import System
from kanegen.recursion.outputs import DIFFERENTIATED, INTEGRATORS, OUTPUTS, PRODUCTS, RATES


def function(model: System | Source | Library, name: str = "forward_dynamics", **options: Any) -> Any:
    """Return a compiled function of CasADi that computes an output, a step or the rates of a state.

    Its derivatives are exact. CasADi gets the Jacobian where there is an output `<name>_derivatives`, and
    where a method of steps has derivatives. For forward and inverse dynamics, forcing and `ode` it gets
    derivatives along one direction and gradients as well, from the outputs `<name>_jvp` and `<name>_vjp`, for
    a few evaluations of the function; and second derivatives, as Ipopt needs for exact Hessians, if the
    source has `<name>_hvp`. Other functions have no second derivatives: a solver approximates the Hessian, as
    Ipopt does with `hessian_approximation="limited-memory"`; or take `expression`.

    Arguments have the names of the arrays in C, such as `x`, `y`, `tau`. CasADi takes all of them in order,
    or some by name: loads and generalized forces that are left out are then 0, and run-time parameters have
    the values of the model. Where [A] is singular or a result is not finite, the evaluation fails, and CasADi
    raises a `RuntimeError`.

    Args:
        model: A system, for which code is generated with all that the function needs; or generated code, or a
            library, from whose source the function is made.
        name: Name of an output, such as "forward_dynamics", of a step, such as "step_rk4", or "ode": {xdot}
            and {ydot} of a state.
        options: Options of `casadi.external`. By default `jac_penalty` is such that CasADi takes the Jacobian
            where it costs fewer operations than derivatives along single directions.

    Returns:
        A `casadi.Function`. It is bound to a file in the cache of kanegen; make it anew on another machine.

    Raises:
        OptionError: If there is no such function, the source does not have it, or its arrays are not of
            doubles.
        MissingError: If CasADi is not installed.
        SingularError: If [A] is singular in every state and the function solves with it.
        BuildError: If there is no C compiler, or it fails.

    Example:
        dynamics = kanegen.interop.casadi.function(kg.load("models/panda_arm.toml"))
        ydot = dynamics(x=x, y=y, tau=tau)["acceleration"]
    """
    package = extras.module("casadi", extra=extras.CASADI)
    source = _source(model, name, with_derivatives=True)
    if reason := ARTIFACTS["casadi"].refusal_of_language(source.target) or other_numbers(source):
        raise OptionError(f"casadi: {reason}")
    wanted = _wanted(source, name).name
    facade = Facade(f"{source.model.name}_casadi", {file_name(source): casadi(source)[file_name(source)]})
    if (penalty := _penalty(source, name)) is not None:
        options = {"jac_penalty": penalty, **options}
    return package.external(wanted, str(build(source, facade=facade)), options)


def expression(model: System | Source | Library, name: str = "forward_dynamics", **options: Any) -> Any:
    """Return a function of CasADi that computes an output or the rates of a state, as expressions of SX.

    It has the inputs and outputs of `function`, the same instructions, and derivatives of every order, which
    CasADi makes; nothing is compiled, and CasADi generates C of it that needs no other. It takes more time
    where CasADi evaluates it. The result is NaN where [A] is singular, and where run-time parameters are left
    out, which have no default values here; there is no status for lost digits.

    Args:
        model: A system, generated code or a library, as for `function`.
        name: Name of an output, or "ode": {xdot} and {ydot} of a state.
        options: Options of `casadi.Function`.

    Returns:
        A `casadi.Function` with the name of the output.

    Raises:
        OptionError: If there is no such function, the source does not have it, or it makes steps.
        MissingError: If CasADi is not installed.
        SingularError: If [A] is singular in every state and the function solves with it.

    Example:
        energy = kanegen.interop.casadi.expression(kg.load("models/panda_arm.toml"), "kinetic_energy")
        matrix, gradient = casadi.hessian(energy(x, y), y)
    """
    package = extras.module("casadi", extra=extras.CASADI)
    if name in INTEGRATORS:
        raise OptionError(
            f"casadi: {name} makes steps, which are C and no expression. Take function, or steps of ode."
        )
    source = _source(model, name, with_derivatives=False)
    wanted = _wanted(source, name)
    if source.module is None:
        raise OptionError(
            "casadi: this source does not carry its programs. Generate it anew with kg.generate."
        )
    inputs, outputs = expressions(package, source.module, wanted)
    names = [one.name for one in wanted.inputs], [one.name for one in wanted.outputs]
    return package.Function(name, inputs, outputs, *names, options)


def _penalty(source: Source, name: str) -> float | None:
    """Return CasADi's option `jac_penalty`, None where there is no choice.

    CasADi takes the whole Jacobian where it needs more weighted sums than this option times the number of
    results, or as many directions, and products with derivatives where it needs fewer. By its default value
    it would take up to twice as many products as there are results, whatever they cost.

    Args:
        source: The source.
        name: Name of the function.
    """
    is_ode = name == ODE
    if source.mass_matrix_pattern or (is_ode and not source.model.speeds_are_rates):
        return None
    products, _ = products_of(source).get(RATES[0] if is_ode else name, (None, None))
    if products is None or not (products.jacobian and products.operations):
        return None
    functions = (products.functions[form] for form in (ALONG, GRADIENT) if form in products.functions)
    each = max((products.operations[one] for one in functions), default=0)
    whole = sum(products.operations[one.function] for one in products.jacobian)
    results = products.rows * (1 + is_ode)
    return max(whole / each, 1.0) / results if each else None


def _wanted(source: Source, name: str) -> CasadiFunction:
    """Return a function that a source gives.

    Raises:
        OptionError: If the source does not have it.
    """
    wanted = symbol(source.model, name)
    for one in casadi_functions(source):
        if one.name == wanted:
            return one
    raise OptionError(
        f"casadi: the source of system {quoted(source.model.shown)} has no function {quoted(name)}. "
        f"Generate it with outputs={outputs_needed(source.system, name) if source.system else (name,)}."
    )


def outputs_needed(system: System, name: str) -> tuple[str, ...]:
    """Return the outputs of a source that gives a function, its Jacobian, and derivatives along directions.

    Args:
        system: The system.
        name: Name of an output, of a step, or "ode".

    Raises:
        OptionError: If there is no such function.

    Example:
        >>> outputs_needed(system, "ode")
        ('forward_dynamics', 'forward_dynamics_derivatives', 'forward_dynamics_vjp', 'forward_dynamics_jvp')
    """
    steps = [method.functions[0] for method in {one.name: one for one in INTEGRATORS.values()}.values()]
    require_one("function", name, (*(one for one in OUTPUTS if one not in DIFFERENTIATED), *steps, ODE))
    if name in INTEGRATORS:
        method = INTEGRATORS[name]
        return (name, method.derivatives) if method.has_derivatives else (name,)
    names = (name,) if name != ODE else RATES[:1] if system.speeds_are_rates else RATES
    matrix = ("mass_matrix",) if name == "inverse_dynamics" else ()
    products = [one for each in names for one in (f"{each}_vjp", f"{each}_jvp") if one in PRODUCTS]
    directional = products if len(names) == 1 else []
    return (*names, *(one for each in names for one in derivatives(system, each)), *matrix, *directional)


def _source(model: System | Source | Library, name: str, *, with_derivatives: bool) -> Source:
    """Return the source of a function; the values of the parameters of a library become the default ones.

    Args:
        model: What a caller passes.
        name: Name of the function.
        with_derivatives: Whether code that is generated has what the Jacobian is made of.

    Raises:
        OptionError: If `model` is none of these.
    """
    if isinstance(model, System):
        outputs = outputs_needed(model, name)
        if not with_derivatives:
            outputs = tuple(one for one in outputs if one not in DIFFERENTIATED)
        return generate(model, outputs, functions=outputs, batches=False)
    if isinstance(model, Library):
        values = tuple(model.parameters.items())
        return replace(model.source, model=replace(model.source.model, parameters=values))
    if isinstance(model, Source):
        return model
    raise OptionError(
        f"casadi: {quoted(model)} is no system. Give what kg.load, kg.generate or kg.build returns."
    )
