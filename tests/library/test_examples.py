"""The examples in the docstrings of libraries and simulations run as they stand."""

from __future__ import annotations

import inspect
import textwrap
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import kanegen as kg
import kanegen.library
from kanegen.recursion.outputs import OUTPUTS, available
from kanegen.simulation import Trajectory, mescd
from tests.support.paths import MODELS

METHODS = [
    name for name, member in inspect.getmembers(kg.Library, inspect.isfunction) if not name.startswith("_")
]


FREE = ("step", "rollout", "step_derivatives", "rhs")
"""Methods whose functions follow motions of systems without contacts; their examples build a library."""


MOTION = ("forward_dynamics", "kinetic_energy", "potential_energy", "momentum")
"""Outputs of the library that examples of simulations use; motions are those without contacts."""


@pytest.fixture(scope="module")
def namespace() -> dict[str, Any]:
    """A held double pendulum whose bodies take loads, its library with all outputs, and a state."""
    system = kg.load(MODELS / "double_pendulum.toml").with_points({"tip": ("lower", (0.7, 0.0, 0.0))})
    system = system.with_contacts(kg.Contact(point="tip", directions=("force1", "force2")))
    system = replace(system, bodies=tuple(replace(body, loads=True) for body in system.bodies))
    library = kg.build(system, available(system), flags="-O0")
    x, y, ydot = np.array([[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]])
    moving = kg.build(system.with_contacts([]), MOTION, flags="-O0")
    trajectory = kg.simulate(moving, x, y, [0.0, 0.1, 0.2], step=0.05)
    modules = {"kanegen": kanegen, "kg": kg, "np": np, "mescd": mescd}
    read = {array.name: array.shape for function in library.source.functions for array in function.inputs}
    state = {"x": x, "y": y, "ydot": ydot, "tau": np.array([0.7, -0.8])}
    state |= {name: np.ones(read[name]) for name in ("weights", "direction", "state_direction")}
    found = {"system": system, "library": library, "moving": moving, "trajectory": trajectory}
    return {**modules, **state, **found}


def example(documented: object) -> str:
    """Return the code of the section "Example" of a docstring."""
    _, _, code = (inspect.getdoc(documented) or "").partition("\nExample:\n")
    return textwrap.dedent(code)


def test_every_output_is_a_method_with_an_example() -> None:
    assert set(OUTPUTS) <= set(METHODS)


@pytest.mark.parametrize("name", METHODS)
def test_the_example_of_a_method(name: str, namespace: dict[str, Any]) -> None:
    code = example(getattr(kg.Library, name))
    assert f".{name}(" in code
    given = dict(namespace)
    if name in FREE:
        given["system"] = namespace["library"].source.system.with_contacts([])
    exec(compile(code, name, "exec"), given)


@pytest.mark.parametrize(
    "documented",
    [kg.Library, kanegen.library.load, kg.simulate, mescd, Trajectory, Trajectory.momentum_drift],
    ids=lambda documented: documented.__name__,
)
def test_other_examples(
    documented: object, namespace: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    code = example(documented)
    assert code
    monkeypatch.chdir(MODELS.parent)
    given = dict(namespace)
    if documented in (kg.simulate, Trajectory):
        given |= {"library": given["moving"], "system": given["moving"].source.system}
    exec(compile(code, "example", "exec"), given)
