"""Expressions of parameters in generated code: their values, and that they cost nothing at run time."""

from __future__ import annotations

from itertools import count
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.model.numbers import Number, is_fixed, value_of
from tests.support.cases import slow_except
from tests.support.random_trees import everything, other_parameters
from tests.support.toml_models import ROD, read_toml

OUTPUTS = ("mass_matrix", "forcing", "forward_dynamics", "kinetic_energy", "frame_jacobians")


def with_own_parameters(system: kg.System) -> kg.System:
    """Return a system with a parameter of its own in the place of every expression of parameters."""
    names = count()

    def change(value: Number) -> Number:
        if is_fixed(value) or not isinstance(value, kg.Expression):
            return value
        return kg.Parameter(f"own{next(names)}", value_of(value))

    return system.map_numbers(change)


@pytest.mark.parametrize("seed", slow_except(range(4), 1))
def test_expressions_cost_nothing_where_the_state_counts(seed: int) -> None:
    system = everything(seed)
    assert with_own_parameters(system) != system
    made = kg.generate(system, outputs=("mass_matrix", "forcing")).operations
    plain = kg.generate(with_own_parameters(system), outputs=("mass_matrix", "forcing")).operations
    assert sum(made.values()) - made["prepare"] <= sum(plain.values()) - plain["prepare"]


def test_a_file_with_expressions_computes_what_numbers_compute(tmp_path: Path) -> None:
    system = read_toml(tmp_path, ROD)
    library = kg.build(system, OUTPUTS)
    rng = np.random.default_rng(0)
    x, y = rng.normal(size=(20, len(system.coordinates))), rng.normal(size=(20, len(system.freedoms)))
    for values in ({}, {"m": 1.2, "l": 0.8, "alpha": -0.7, "g": 1.6}):
        plain = kg.build(system.with_parameters(values).map_numbers(value_of), OUTPUTS)
        found = library.with_parameters(values)
        for name in OUTPUTS:
            arguments = (x,) if name in ("mass_matrix", "frame_jacobians") else (x, y)
            expected = getattr(plain, name)(*arguments)
            # A few roundings in the numbers of the model, and the condition of [A] in forward dynamics.
            assert getattr(found, name)(*arguments) == pytest.approx(expected, rel=1e-11, abs=1e-12), name


@pytest.mark.parametrize("seed", slow_except((0, 5), 5))
def test_other_parameters_in_random_trees(seed: int) -> None:
    system = everything(seed)
    report = kg.compare(system.with_parameters(other_parameters(system, seed)), states=20)
    assert report.passed, report


def test_lengths_that_are_opposite_have_one_name() -> None:
    """A welded arm leads out by 3 l/2 + b, and the next joint back by the same, in other words."""

    def there_and_back(out: Number, back: Number) -> dict[str, int]:
        hinge, weld = (False, True, False, False, False, False), (False,) * 6
        bodies = (
            kg.Body("first", 0, 2.0, np.eye(3), joint=kg.Joint(free=hinge)),
            kg.Body("arm", 1, 1.0, np.eye(3), joint=kg.Joint(position=(out, 0, 0), free=weld)),
            kg.Body("last", 2, 1.0, np.eye(3), (0.3, 0, 0), kg.Joint(position=(back, 0, 0), free=hinge)),
        )
        return kg.generate(kg.System("both", bodies), outputs=("mass_matrix", "forcing")).operations

    length, b = kg.Parameter("l", 0.5), kg.Parameter("b", 0.25)
    opposite = there_and_back(1.5 * length + b, -b - length * 3 / 2)
    out = kg.Parameter("out", 1.0)
    assert {**opposite, "prepare": 0} == {**there_and_back(out, -out), "prepare": 0}
    assert opposite["multiply"] < there_and_back(1.5 * length + b, -b - length)["multiply"]
