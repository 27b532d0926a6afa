"""Second derivatives: against products of Hessians, which `test_products` compares with differences."""

from __future__ import annotations

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.program.evaluate import evaluate
from kanegen.recursion.outputs import DIFFERENTIATED
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.orientation_trees import close, mixed, with_quaternions
from tests.support.paths import MODELS
from tests.support.random_trees import everything

SYSTEMS = {
    "slides and hinges": lambda: systems.random_system(np.random.default_rng(1), 2, loads=True),
    "three angles": lambda: mixed(1),
    "quaternions": lambda: with_quaternions(1),
    "parameters": lambda: kg.load(MODELS / "gantry_crane.toml"),
    "everything": lambda: everything(3, 1),
}

CASES = [(kind, base) for kind in SYSTEMS for base in ("inverse_dynamics", "forward_dynamics")]
USUAL = (("slides and hinges", "inverse_dynamics"),)


@pytest.mark.parametrize("case", slow_except(CASES, *USUAL))
def test_products_of_all_second_derivatives(case: tuple[str, str]) -> None:
    """Weights times second derivatives times a direction are the product of the Hessian."""
    kind, base = case
    system, rng = SYSTEMS[kind](), np.random.default_rng(5)
    names = f"{base}_second_derivatives", f"{base}_hvp"
    module, n = compile_module(system, names).module, len(system.freedoms)
    arrays = {array.name: array.size for program in module.functions.values() for array in program.inputs}
    given = {name: rng.uniform(-1, 1, size) for name, size in sorted(arrays.items())}
    if module.prepare is not None:
        parameters = [parameter.value for parameter in system.parameters]
        given |= evaluate(module.prepare, {"parameters": parameters}, np)
    own, every = (DIFFERENTIATED[name].columns_of(system) for name in names)
    places = np.concatenate([np.arange(every[array].start, every[array].stop) for array in own])
    direction = np.zeros(arrays["direction"])
    direction[places] = given["direction"][places]
    (product,) = evaluate(module.functions[names[1]], given | {"direction": direction}, np).values()
    (found,) = evaluate(module.functions[names[0]], given, np).values()
    second = np.array(found, dtype=float).reshape(n, len(places), len(places))
    assert (second == second.swapaxes(1, 2)).all()
    contracted = np.einsum("i,iab,b->a", given["weights"], second, direction[places])
    close(contracted, np.array(product, dtype=float)[places], 1e-10)


def test_large_systems_are_refused_in_one_line() -> None:
    system = kg.load(MODELS / "eight_body.toml")
    message = (
        "output 'forward_dynamics_second_derivatives': system 'eight_body' has 995328 second derivatives, "
        "and there is code for 8192 at most. Ask for forward_dynamics_hvp, their product with weights and a "
        "direction."
    )
    with pytest.raises(kg.OptionError) as found:
        kg.generate(system, ["forward_dynamics_second_derivatives"])
    assert str(found.value) == message


def test_a_library_returns_symmetric_matrices() -> None:
    """Also in batches; the derivative by {tau} twice is zero, by structure."""
    system = kg.load(MODELS / "double_pendulum.toml")
    library = kg.build(system, ["forward_dynamics_second_derivatives"])
    by = library.derivative_columns("forward_dynamics_second_derivatives")
    x, y = np.random.default_rng(2).normal(size=(2, 3, 2))
    found = library.forward_dynamics_second_derivatives(x, y)
    assert found.shape == (3, 2, 11, 11)
    assert (found == found.swapaxes(2, 3)).all()
    assert not found[:, :, by["tau"], by["tau"]].any()
    assert (library.forward_dynamics_second_derivatives(x[1], y[1]) == found[1]).all()
