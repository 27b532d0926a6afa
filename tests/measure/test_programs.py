"""Symbolic and numeric programs on the same states: errors, the worst state, and their picture."""

from __future__ import annotations

from collections.abc import Callable
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, settings

import kanegen as kg
from kanegen.errors import OptionError
from kanegen.measure.comparison import compare
from kanegen.measure.programs import Programs, measure_programs, yardstick
from kanegen.measure.programs.program import Program, Results, of_reference
from kanegen.model.arrays import Floats
from kanegen.program.precision import FLOAT
from kanegen.reference import equations as reference
from kanegen.reference.magnitudes import rounding_bound
from kanegen.reference.states import States
from tests.support import systems
from tests.support.paths import ROOT

EVERY = (
    "closed form",
    "definitions in NumPy",
    "reference",
    "C in double precision",
    "C in single precision",
)


def model(name: str) -> kg.System:
    return kg.load(ROOT / "models" / f"{name}.toml")


def changed(system: kg.System, change: Callable[[Floats], None]) -> Program:
    """The reference with a change to {f}, as a program named "changed"."""

    def results(states: States) -> Results:
        found = dict(of_reference(system).results(states))
        change(found["forcing"])
        return found

    return Program("changed", results)


def titles(svg: str) -> list[str]:
    """The titles of the parts of a picture, which must be well-formed."""
    root = ElementTree.fromstring(svg)
    return [node.text or "" for node in root.iter("{http://www.w3.org/2000/svg}title")]


@pytest.fixture(scope="module")
def top() -> Programs:
    return kg.compare(model("spinning_top"), states=5).programs(states=24)


def test_all_programs_agree_with_certified_truth_up_to_their_rounding(top: Programs) -> None:
    assert top.names == EVERY
    assert top.truth.words == "certified truth" and not top.notes
    for one in top.programs:
        bound = rounding_bound(1, FLOAT, FLOAT) if "single" in one.name else rounding_bound(1)
        for output in ("mass_matrix", "forcing"):
            assert one.entries[output].max() <= bound
    assert top.errors("C in single precision").entries["forcing"].max() > 1e-9


@settings(max_examples=6, deadline=None, derandomize=True)
@given(systems.systems(max_bodies=2))
def test_symbolic_programs_of_random_systems_keep_half_of_the_bound(system: kg.System) -> None:
    """The bound allows for the rounding of two programs, and certified truth has none."""
    programs = measure_programs(system, [], states=4)
    for one in programs.programs:
        for errors in one.entries.values():
            assert errors.max() <= rounding_bound(system.number_of_bodies) / 2


def test_a_mass_matrix_that_is_always_singular_has_no_accelerations() -> None:
    free = systems.flags(2, ["theta3"])
    inertia, zero = [np.eye(3), np.zeros((3, 3))], [[0.0, 0.0, 0.0]] * 2
    system = kg.System.from_arrays([0, 1], [2.0, 0.0], inertia, zero, zero, free=free)
    programs = kg.compare(system, states=2).programs(states=2)
    assert programs.names == EVERY
    assert not programs.truth.distances.any()
    assert all(np.isnan(one.accelerations).all() for one in programs.programs)
    assert "no exact accelerations" in programs.plot().svg


def test_half_of_the_states_approach_gimbal_lock(top: Programs) -> None:
    """There the solution by NumPy loses digits in proportion to the distance; that of the C does not."""
    near = top.truth.distances < 1e-5
    assert 0 < near.sum() <= 12
    assert top.errors("reference").accelerations[near].max() > 1e-13
    assert top.errors("C in double precision").accelerations.max() < 1e-13


def test_distances_are_those_of_the_scaled_matrix() -> None:
    system = model("double_pendulum")
    programs = measure_programs(system, [], states=6)
    for x, distance in zip(programs.states.x, programs.truth.distances, strict=True):
        matrix = reference.mass_matrix(system.values(), x[None])[0]
        scale = 1 / np.sqrt(np.diag(matrix))
        assert distance == pytest.approx(1 / np.linalg.cond(matrix * np.outer(scale, scale)), rel=1e-9)


def test_the_worst_entry_is_found_and_can_be_computed_again() -> None:
    system = model("double_pendulum")

    def change(forcing: Floats) -> None:
        forcing[4, 1] *= 1 + 1e-6

    programs = measure_programs(system, [changed(system, change)], states=8)
    worst = programs.worst("forcing")
    assert (worst.state, worst.entry) == (4, "[q2]")
    assert worst == programs.worst("forcing", "changed")
    again = reference.forcing(system.values(), np.array([worst.x]), np.array([worst.y]), None, None)[0, 1]
    assert worst.reference == pytest.approx(again, rel=1e-14)
    assert worst.value == pytest.approx(again * (1 + 1e-6), rel=1e-14)
    assert programs.errors("reference").entries["forcing"].max() < 1e-14
    shown = [title for title in titles(programs.plot().svg) if title.startswith("changed")]
    assert any("{f}[q2]" in title and f"x = {list(worst.x)}" in title for title in shown)
    assert any("the worst" in title and f"state 4: x = {list(worst.x)}" in title for title in shown)


def test_a_program_without_a_finite_result_is_drawn_and_named() -> None:
    system = model("double_pendulum")

    def change(forcing: Floats) -> None:
        forcing[2, 0] = np.nan

    programs = measure_programs(system, [changed(system, change)], states=6)
    worst = programs.worst()
    assert (worst.state, worst.entry) == (2, "[q1]") and np.isnan(worst.value)
    assert "inf" in str(programs)
    assert titles(programs.plot().svg)


def test_the_picture_is_the_same_each_time_and_names_every_program(top: Programs) -> None:
    picture = top.plot()
    assert picture.svg == top.plot().svg == picture._repr_svg_()
    found = titles(picture.svg)
    for name in EVERY:
        assert name in picture.svg
        assert sum(title.startswith(f"{name}: the worst") for title in found) == 3
        assert sum(title.startswith(f"{name}: ") and "in state" in title for title in found) >= 3 * 24
    assert "tip:" not in picture.svg


def test_without_certified_truth_the_reference_is_the_yardstick(monkeypatch: pytest.MonkeyPatch) -> None:
    car = measure_programs(model("quarter_car"), [], states=4)
    assert car.truth.words == "the reference" and "reference" not in car.names
    assert car.notes[0].endswith("no certified truth with prescribed freedoms and force elements.")
    assert car.errors("closed form").entries["forcing"].max() <= rounding_bound(2)
    assert "no exact accelerations" in car.plot().svg
    monkeypatch.setattr(yardstick, "is_installed", lambda package: False)
    pendulum = measure_programs(model("double_pendulum"), [], states=4)
    assert "pip install 'kanegen[study]'" in str(pendulum)
    assert np.all(pendulum.truth.distances > 0)


def test_the_variant_that_was_checked_is_among_the_programs() -> None:
    programs = kg.compare(model("double_pendulum"), states=2, precision="double-double").programs(states=4)
    assert programs.names == (*EVERY, "C as checked")
    assert programs.errors("C as checked").entries["forcing"].max() < rounding_bound(2)


def test_states_in_which_a_force_is_undefined_are_left_out() -> None:
    pendulum = model("double_pendulum")
    root = kg.Drive("q1", "sqrt(x.q1)")
    programs = measure_programs(pendulum.with_force_elements(root), [], states=20)
    assert "states are left out" in str(programs)
    assert 0 < len(programs.states) < 20
    assert (programs.states.x[:, 0] >= 0).all()
    assert programs.errors("closed form").entries["forcing"].max() <= rounding_bound(2)


def test_bad_requests_have_one_clear_line(top: Programs) -> None:
    with pytest.raises(OptionError, match="unknown program 'C in doubel precision'"):
        top.worst("forcing", "C in doubel precision")
    with pytest.raises(OptionError, match="unknown output 'energy'"):
        top.worst("energy")
    report = kg.compare(model("double_pendulum"), states=2)
    with pytest.raises(OptionError, match="two are the fewest"):
        report.programs(states=1)
    bare = compare(model("double_pendulum"), kg.build(model("double_pendulum")), states=2)
    assert bare == report
    with pytest.raises(OptionError, match=r"Only a report of kg\.compare"):
        bare.plot()
