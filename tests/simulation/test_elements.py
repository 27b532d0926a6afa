"""Names and units of the numbers of all outputs, for models of many kinds."""

from __future__ import annotations

import math

import pytest

import kanegen as kg
from kanegen.recursion.outputs import available
from kanegen.simulation.elements import axes_of, elements, output_array, rate_unit
from tests.support.cases import slow_except
from tests.support.paths import MODELS


@pytest.fixture(scope="module", params=slow_except(["cart_pole", "quarter_car", "spinning_top"], "cart_pole"))
def source(request: pytest.FixtureRequest) -> kg.Source:
    """C of all outputs of a model, whose tip is a point that is held where the model has none."""
    system = kg.load(MODELS / f"{request.param}.toml")
    if not system.points:
        system = system.with_points({"tip": (system.bodies[-1].name, (0.1, 0.2, 0.3))})
    return kg.generate(system, available(system))


def test_every_number_has_a_name_of_its_own_and_a_unit(source: kg.Source) -> None:
    seen: set[str] = set()
    for output in source.outputs:
        found, array = elements(source, output), output_array(source, output)
        assert len(found) == math.prod(array.shape)
        assert all(one.name == output or one.name.startswith(f"{output}.") for one in found)
        assert all(one.unit == array.unit or one.unit in array.unit.split(", ") for one in found), output
        assert [len(axis.labels) for axis in axes_of(source, output)] == list(array.shape)
        names = {one.name for one in found}
        assert len(names) == len(found) and not names & seen
        seen |= names


def test_units_of_numbers_that_belong_to_freedoms(source: kg.Source) -> None:
    kinds = source.model.freedom_units
    units = {
        "forcing": {"rad": "N m", "m": "N"},
        "forward_dynamics": {"rad": "rad/s^2", "m": "m/s^2"},
        "regularity": {"rad": "1", "m": "1"},
    }
    for output, by_kind in units.items():
        assert [one.unit for one in elements(source, output)] == [by_kind[kind] for kind in kinds]
    of_matrix = {("rad", "rad"): "kg m^2", ("rad", "m"): "kg m", ("m", "rad"): "kg m", ("m", "m"): "kg"}
    expected = [of_matrix[row, column] for row in kinds for column in kinds]
    assert [one.unit for one in elements(source, "mass_matrix")] == expected
    assert [one.unit for one in elements(source, "momentum")] == ["kg m/s"] * 3 + ["kg m^2/s"] * 3
    speeds = [one.unit for one in elements(source, "frame_velocities")]
    assert speeds == (["rad/s"] * 3 + ["m/s"] * 3) * (len(speeds) // 6)
    assert [rate_unit(unit) for unit in ("rad", "m", "1")] == ["rad/s", "m/s", "1/s"]
