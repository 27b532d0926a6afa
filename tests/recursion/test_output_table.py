"""The table of outputs: an entry is all that the pipeline needs, and Python methods agree with it."""

from __future__ import annotations

import inspect
import re

import numpy as np
import pytest

import kanegen as kg
from kanegen.program.ir import Array
from kanegen.recursion.kinematics import angular_velocities
from kanegen.recursion.outputs import OUTPUTS, Output, Recursion, chosen
from kanegen.recursion.tree import Derived, Tree
from kanegen.reference.kinematics import kinematics
from tests.support import systems
from tests.support.paths import ROOT


def last_angular_velocity(tree: Tree) -> Derived:
    """Derive {omega'_N} of the last body, in its frame."""
    return Derived(angular_velocities(tree)[-1])


ADDED = Output(
    "last_angular_velocity",
    lambda system: Array("omega_last", (3,), "rad/s", "{omega'_N}, Eq. (11), body components"),
    ("x", "y"),
    Recursion("velocities of the bodies", last_angular_velocity),
)


def test_a_new_output_is_a_derivation_and_an_entry(monkeypatch: pytest.MonkeyPatch) -> None:
    """C, header, batch form and Python result follow from it; only a typed method is written by hand."""
    monkeypatch.setitem(OUTPUTS, ADDED.name, ADDED)
    system = systems.random_system(np.random.default_rng(11), 3)
    n = len(system.freedoms)
    library = kg.build(system, ("mass_matrix", ADDED.name))
    prototype = f"int tree_{ADDED.name}(const double x[{n}], const double y[{n}], double omega_last[3]);"
    assert prototype in library.source.files["tree.h"]
    assert "Eq. (11), body components; by velocities of the bodies" in " ".join(
        library.source.files["tree.h"].split()
    ).replace(" * ", " ")
    x, y = np.random.default_rng(12).normal(size=(2, 5, n))
    expected = kinematics(system.values(), x, y)[-1].omega
    margin = 1e-14 * np.abs(expected).max()  # a few roundoffs of numbers of this size
    assert library.evaluate(x, y)[1] == pytest.approx(expected, abs=margin)
    assert library.evaluate(x[0], y[0])[1] == pytest.approx(expected[0], abs=margin)
    assert chosen([ADDED.name, "forcing"]) == ("forcing", ADDED.name)


@pytest.mark.parametrize("name", OUTPUTS)
def test_every_output_has_a_method_with_its_arguments(name: str) -> None:
    method = inspect.signature(getattr(kg.Library, name))
    positional = [p for p in method.parameters.values() if p.kind is p.POSITIONAL_OR_KEYWORD]
    assert tuple(parameter.name for parameter in positional[1:]) == OUTPUTS[name].arguments
    optional = {p.name for p in positional if p.default is None}
    assert optional == {"tau", "force", "torque"} & set(OUTPUTS[name].inputs)


def test_an_output_is_named_in_few_files() -> None:
    """Derivation, entry, method, reference, help of the command line, names of elements and in C."""
    sources = {path.relative_to(ROOT).as_posix(): path for path in (ROOT / "kanegen").rglob("*.py")}
    word = re.compile(r"\bcentroidal_momentum_bias\b")
    naming = {name for name, path in sources.items() if word.search(path.read_text())}
    assert "kanegen/recursion/outputs/table.py" in naming
    assert "kanegen/recursion/centroidal.py" in naming
    assert len(naming | {"kanegen/recursion/meanings.py"}) <= 8
