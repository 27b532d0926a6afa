"""The examples in the docstrings of `Library` run as they stand."""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Iterator

import numpy as np
import pytest

import kanegen as kg
import kanegen.library
from kanegen.recursion.outputs import OUTPUTS, available
from tests.support.paths import MODELS

METHODS = [
    name for name, member in inspect.getmembers(kg.Library, inspect.isfunction) if not name.startswith("_")
]


@pytest.fixture(scope="module")
def namespace() -> dict[str, object]:
    """A double pendulum with a point, its library with all outputs, and a state, which the examples use."""
    system = kg.load(MODELS / "double_pendulum.toml").with_points({"tip": ("lower", (0.7, 0.0, 0.0))})
    library = kg.build(system, available(system), flags="-O0")
    x, y, ydot = np.array([[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]])
    modules = {"kanegen": kanegen, "kg": kg, "np": np}
    return {**modules, "system": system, "library": library, "x": x, "y": y, "ydot": ydot}


def example(documented: object) -> str:
    """Return the code of the section "Example" of a docstring."""
    _, _, code = (inspect.getdoc(documented) or "").partition("\nExample:\n")
    return textwrap.dedent(code)


def test_every_output_is_a_method_with_an_example() -> None:
    assert set(OUTPUTS) <= set(METHODS)


@pytest.mark.parametrize("name", METHODS)
def test_the_example_of_a_method(name: str, namespace: dict[str, object]) -> None:
    code = example(getattr(kg.Library, name))
    assert f".{name}(" in code
    exec(compile(code, name, "exec"), dict(namespace))


def sections() -> Iterator[str]:
    """Yield the examples of the class and of `load`."""
    yield example(kg.Library)
    yield example(kanegen.library.load)


def test_the_examples_of_the_class_and_of_load(
    namespace: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(MODELS.parent)
    for code in sections():
        assert code
        exec(compile(code, "example", "exec"), dict(namespace))
