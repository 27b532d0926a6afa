"""Comparisons with the reference: right programs stay within the bound, and no mutant passes."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from numpy.typing import NDArray

import kanegen as kg
from kanegen.errors import ArrayError, OptionError
from kanegen.measure import comparison
from kanegen.measure.comparison import compare
from kanegen.reference import equations as reference
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import forcing_magnitude, mass_matrix_magnitude, path_maxima, rounding_bound
from kanegen.reference.special_states import kinks, special_states
from kanegen.reference.states import random_states
from tests.support import systems
from tests.support.high_precision import true_values
from tests.support.slide import slide

Numbers = NDArray[Any]


class Library:
    """The reference in the place of a library, with a function that may change each output."""

    def __init__(
        self,
        system: kg.System,
        matrix: Callable[[Numbers], Numbers] = lambda a: a,
        forcing: Callable[[Numbers, reference.ForcingTerms], Numbers] = lambda f, terms: f,
        outputs: tuple[str, ...] = ("mass_matrix", "forcing"),
    ) -> None:
        self.system, self.matrix, self.vector, self.outputs = system, matrix, forcing, outputs

    def mass_matrix(self, x: Numbers) -> Numbers:
        return self.matrix(reference.mass_matrix(self.system, x))

    def forcing(
        self, x: Numbers, y: Numbers, force: Numbers | None = None, torque: Numbers | None = None
    ) -> Numbers:
        terms = reference.forcing_terms(self.system, x, y, force, torque)
        return self.vector(terms.total, terms)


def changed(index: int, factor: float) -> Callable[..., Numbers]:
    """Return a function that multiplies one entry of {f}, or one row and column of [A], in every state."""

    def change(values: Numbers, *_: Any) -> Numbers:
        values = values.copy()
        values[:, index] *= factor
        if values.ndim == 3:
            values[:, :, index] *= factor
        return values

    return change


# The bound


def test_reference_keeps_its_half_of_the_bound() -> None:
    """Errors against 40 digits stay within half of the bound, and reach 2 % of the whole bound."""
    rng, shares = np.random.default_rng(6), []
    for bodies in (1, 1, 1, 1, 2, 2, 2, 3, 3, 4, 5, 6):
        system = systems.random_system(rng, bodies, locked=bodies % 2 == 1).values()
        states = random_states(system, 3, seed=bodies)
        truth = true_values(system, states)
        maxima = path_maxima(system, kinematics(system, states.x, states.y), states.y)
        a = reference.mass_matrix(system, states.x)
        f = reference.forcing(system, states.x, states.y, states.force, states.torque)
        a_size = mass_matrix_magnitude(system, maxima)
        f_size = forcing_magnitude(system, maxima, states.force, states.torque)
        for value, true, size in ((a, truth["mass_matrix"], a_size), (f, truth["forcing"], f_size)):
            error = np.abs(value - true).astype(np.float64)
            assert (np.abs(value) <= size * (1 + 1e-14)).all()
            assert (error <= size * rounding_bound(bodies) / 2).all()
            shares.append((error[size > 0] / size[size > 0]).max() / rounding_bound(bodies))
    assert max(shares) > 0.02


@settings(max_examples=40, deadline=None, derandomize=True)
@given(systems.systems(max_bodies=8))
def test_magnitudes_scale_like_what_they_measure(system: kg.System) -> None:
    """Scaling masses, lengths and times by powers of two changes no bit of a magnitude but its unit."""
    arrays, states = system.values(), random_states(system, 2)
    mass, length, time = 2.0**30, 2.0**-9, 2.0**11
    units = np.where([freedom.is_angle for freedom in system.freedoms], 1.0, length)
    scaled = systems.rescaled(arrays, mass, length, time)
    arm = length / units
    sizes = []
    for model, x, y in ((arrays, states.x, states.y), (scaled, states.x * units, states.y * (units / time))):
        maxima = path_maxima(model, kinematics(model, x, y), y)
        sizes.append((mass_matrix_magnitude(model, maxima), forcing_magnitude(model, maxima, None, None)))
    np.testing.assert_array_equal(sizes[1][0], sizes[0][0] * np.outer(arm, arm) * mass)
    np.testing.assert_array_equal(sizes[1][1], sizes[0][1] * arm * (mass * length / time**2))


# Mutants


MUTANTS: dict[str, dict[str, Any]] = {
    "all of A by 1e-9": {"matrix": lambda a: a * (1 + 1e-9)},
    "all of f by 1e-9": {"forcing": lambda f, terms: f * (1 + 1e-9)},
    "an angle's row by 1e-9": {"matrix": changed(0, 1 + 1e-9)},
    "a translation's row by 1e-9": {"matrix": changed(-1, 1 + 1e-9)},
    "an angle's entry by 1e-9": {"forcing": changed(0, 1 + 1e-9)},
    "a translation's entry by 1e-9": {"forcing": changed(-1, 1 + 1e-9)},
    "sign of a row": {"matrix": changed(1, -1.0)},
    "sign of an entry": {"forcing": changed(1, -1.0)},
    "A not symmetric": {"matrix": np.tril},
    "A in single precision": {"matrix": lambda a: a.astype(np.float32).astype(float)},
    "A of another state": {"matrix": lambda a: np.roll(a, 1, axis=0)},
    "no loads": {"forcing": lambda f, terms: f - terms.loads},
    "no gravity": {"forcing": lambda f, terms: f - terms.gravity},
    "no m v_y dot": {"forcing": lambda f, terms: f - terms.acceleration},
    "no omega x v": {"forcing": lambda f, terms: f - terms.transport},
    "no I omega_y dot": {"forcing": lambda f, terms: f - terms.angular},
    "no omega x I omega": {"forcing": lambda f, terms: f - terms.gyroscopic},
}


@pytest.mark.parametrize("mutant", MUTANTS)
@pytest.mark.parametrize("size", [1e-4, 1.0, 1e3])
def test_mutants_fail(mutant: str, size: float) -> None:
    free = np.ones((4, 6), bool)
    system = systems.random_system(np.random.default_rng(3), 4, free=free, loads=True, size=size)
    assert compare(system, Library(system), states=20).passed
    report = compare(system, Library(system, **MUTANTS[mutant]), states=20)
    assert not report.passed
    assert report.max_error > 1e-12
    assert "FAILED" in str(report)


def test_a_mutant_is_caught_in_a_long_chain() -> None:
    system = systems.chain(64)
    assert not compare(system, Library(system, matrix=changed(0, 1 + 1e-9)), states=5).passed
    assert not compare(system, Library(system, forcing=changed(0, 1 + 1e-9)), states=5).passed


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_result_that_is_not_finite_fails_and_is_shown(bad: float) -> None:
    system = systems.eight_body()

    def changed_entry(f: Numbers, terms: reference.ForcingTerms) -> Numbers:
        f = f.copy()
        f[2, 4] = bad
        return f

    report = compare(system, Library(system, forcing=changed_entry), states=5)
    matrix, forcing = report.accuracies
    assert matrix.passed and not forcing.passed and not report.passed
    assert report.max_error == np.inf
    assert forcing.not_finite == 1
    assert forcing.normwise_median < 1e-15
    assert (forcing.worst.state, forcing.worst.entry) == (2, "[body2.theta2]")
    assert f"{bad!r} instead of {forcing.worst.reference!r}" in str(report)
    assert "forcing: 1 state is not finite" in str(report)
    json.dumps(report.as_dict(), allow_nan=False)


# The report


def test_the_worst_state_can_be_computed_again() -> None:
    system = systems.eight_body()
    report = compare(system, Library(system, matrix=changed(3, 1 + 1e-9), forcing=changed(7, -1.0)), states=9)
    matrix, forcing = (accuracy.worst for accuracy in report.accuracies)
    names = system.freedom_names
    assert f"[{names[3]}, {names[3]}]" == matrix.entry
    assert reference.mass_matrix(system, matrix.x)[3, 3] == pytest.approx(matrix.reference, rel=1e-14)
    again = reference.forcing(system, forcing.x, forcing.y, forcing.force, forcing.torque)
    assert again[7] == pytest.approx(forcing.reference, rel=1e-14)
    assert forcing.value == -forcing.reference
    assert repr(forcing.x) in str(report)
    assert json.loads(json.dumps(report.as_dict()))["accuracies"][1]["worst"]["x"] == list(forcing.x)


@pytest.mark.parametrize("seed", range(6))
def test_each_error_stands_beside_its_own_bound(seed: int) -> None:
    """An error by a share s of the terms is s componentwise, and s times the cancellation normwise."""
    system = systems.random_system(np.random.default_rng(seed), 3, free=np.ones((3, 6), bool))
    share = 0.9 * rounding_bound(3)

    class Shifted(Library):
        def forcing(self, x: Numbers, y: Numbers, *loads: Any, **named: Any) -> Numbers:
            arrays = self.system.values()
            maxima = path_maxima(arrays, kinematics(arrays, x, y), y)
            shift = share * forcing_magnitude(arrays, maxima, named.get("force"), named.get("torque"))
            return super().forcing(x, y, *loads, **named) + shift

    report = compare(system, Shifted(system), states=40)
    matrix, forcing = report.accuracies
    assert report.passed
    assert forcing.componentwise == pytest.approx(share, rel=0.1)
    assert 0.8 * forcing.normwise_bound < forcing.normwise <= forcing.normwise_bound
    assert forcing.normwise > forcing.bound < forcing.normwise_bound
    assert matrix.normwise <= matrix.normwise_bound
    head, *rows = (line.split() for line in report.table().splitlines())
    assert head == ["output", "error", "max", "median", "bound"]
    kinds = [row[-5:] for row in rows]
    assert kinds[2] == [
        "componentwise",
        *(f"{v:.1e}" for v in (forcing.componentwise, forcing.componentwise_median, forcing.bound)),
        "ok",
    ]
    assert kinds[3] == [
        "normwise",
        *(f"{v:.1e}" for v in (forcing.normwise, forcing.normwise_median, forcing.normwise_bound)),
        "ok",
    ]


def test_normwise_error_is_relative_and_has_no_units() -> None:
    for size in (1e-3, 1.0, 1e4):
        system = systems.random_system(np.random.default_rng(3), 3, free=np.ones((3, 6), bool), size=size)
        report = compare(system, Library(system, lambda a: a * 1.001, lambda f, terms: f * 1.002), states=7)
        matrix, forcing = report.accuracies
        assert matrix.normwise == pytest.approx(1e-3) == matrix.normwise_median
        assert forcing.normwise == pytest.approx(2e-3) == report.max_error
        assert matrix.componentwise <= 1.001e-3
        assert forcing.cancellation > 1


def test_forces_that_cancel_to_nothing_are_no_error() -> None:
    """Without gravity and loads no force acts on a sphere, though separate terms of Eq. (44) are not zero."""
    system = kg.System.from_arrays(
        [0], [2.0], [np.eye(3)], [[0, 0, 0]], [[0, 0, 0]], gravity=(0, 0, 0),
        free=systems.flags(1, ["theta3", "s1", "s2"]),
    )  # fmt: skip
    report = compare(system, Library(system, forcing=lambda f, terms: 0 * f), states=50)
    assert report.passed
    assert report.max_error < 1e-15


def test_one_output_is_enough() -> None:
    system = systems.chain(2)
    report = compare(system, Library(system, outputs=("forcing", "energy")), states=3)
    assert [accuracy.output for accuracy in report.accuracies] == ["forcing"]


def test_the_same_seed_gives_the_same_report() -> None:
    system = systems.eight_body()
    library = Library(system, matrix=changed(0, 1 + 1e-9))
    assert compare(system, library, 10, seed=4) == compare(system, library, 10, seed=4)
    assert compare(system, library, 10, seed=4) != compare(system, library, 10, seed=5)


def test_bad_requests_are_refused() -> None:
    system = systems.chain(2)
    with pytest.raises(OptionError, match="states is 0; it must be a whole number from 1 to"):
        compare(system, Library(system), states=0)
    with pytest.raises(OptionError, match=r"states is 2\.5; it must be a whole number"):
        compare(system, Library(system), states=2.5)
    with pytest.raises(OptionError, match="seed is -1; it must be a whole number from 0 to"):
        compare(system, Library(system), seed=-1)
    with pytest.raises(OptionError, match="none of the outputs mass_matrix, forcing: nothing to compare"):
        compare(system, Library(system, outputs=()))
    with pytest.raises(ArrayError, match=r"returned shape \(10, 2\); expected \(10, 2, 2\)"):
        compare(system, Library(system, matrix=lambda a: a[:, 0]), states=5)


# States and batches


class WrongInOneState(Library):
    """The reference, but for one state of all that it is called with, in which an entry is off by 1e-9."""

    def __init__(self, system: kg.System, wrong: int) -> None:
        super().__init__(system, matrix=self._changed, outputs=("mass_matrix",))
        self.wrong, self.seen = wrong, 0

    def _changed(self, values: Numbers) -> Numbers:
        values, place = values.copy(), self.wrong - self.seen
        self.seen += len(values)
        if 0 <= place < len(values):
            values[place, 0, 0] *= 1 + 1e-9
        return values


@pytest.mark.parametrize("states", [1, 7, 8, 9, 12])
def test_every_state_of_every_batch_is_compared(states: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whichever state is wrong is found and named; batches hold four states here."""
    system = systems.chain(2)
    monkeypatch.setattr(comparison, "BATCH_NUMBERS", 4 * 3 * 12**2)
    assert compare(system, Library(system), states).passed
    every = states + len(special_states(system, random_states(system, states)).states)
    for wrong in range(every):
        library = WrongInOneState(system, wrong)
        report = compare(system, library, states)
        assert library.seen == every
        assert not report.passed
        assert report.accuracies[0].worst.state == wrong


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("sign(y.q)", "1 if y.q >= 0 else -1"),  # differs where y.q is 0
        ("sign(y.q - 2*x.p)", "1 if y.q - 2*x.p > -1e-9 else -1"),  # differs just below the jump
        ("0.1 if x.q < 0.3 else 0.2", "0.1 if x.q <= 0.3 else 0.2"),
        (
            "max(x.q, y.q)*abs(x.q)",
            "max(x.q, y.q)*abs(x.q) + (1 if x.q <= 0 and y.q <= 0 and x.q + y.q >= 0 else 0)",
        ),
    ],
)
def test_differences_at_kinks_at_rest_and_at_the_origin_are_found(text: str, wrong: str) -> None:
    """The other library agrees in every random state, and differs in states that are no accident."""
    system, library = slide(text), kg.build(slide(wrong))
    sample = random_states(system, 200)
    expected = kg.build(system).forcing(sample.x, sample.y)
    assert (library.forcing(sample.x, sample.y) == expected).all()
    report = compare(system, library, states=200)
    assert not report.passed
    assert compare(system, kg.build(system), states=200).passed
    assert "at rest or at the origin and" in str(report)


def test_states_without_forces_are_left_out_and_counted() -> None:
    report = kg.compare(slide("y.q/abs(y.q)"), states=20)
    assert report.passed
    assert report.special == "1 at rest or at the origin; {f} is undefined in 10 more"


def test_random_states_without_forces_are_left_out_counted_and_explained() -> None:
    system = slide("sqrt(x.q) + 3*x.p").with_force_elements(kg.Drive("p", "exp(-y.q**2)"))
    report = kg.compare(system, states=200)
    undefined = int((random_states(system, 200).x[:, 0] < 0).sum())
    assert report.passed and 50 < undefined < 150
    assert report.undefined.startswith(f"{{f}} is undefined in {undefined} of 200 random states, in the ref")
    assert "Undefined there: drive: freedom = b0.s1, effort = sqrt(x.b0.s1)" in report.undefined
    assert "exp" not in report.undefined
    assert "Limits on x.q, x.p in the model would" in report.undefined and report.undefined in str(report)
    limited = system.with_limits({"q": {"position": (0.1, 1.0)}})
    assert kg.compare(limited, states=200).undefined == ""


def test_a_library_with_forces_where_the_reference_has_none_or_the_other_way_round_fails() -> None:
    whole, partial = slide("x.p"), slide("x.p + 1e-20*sqrt(x.q)")
    assert compare(partial, kg.build(whole), states=50).accuracies[1].not_finite > 0
    assert compare(whole, kg.build(partial, on_status="ignore"), states=50).accuracies[1].not_finite > 0
    nowhere = slide("x.p + sqrt(-1 - x.q**2)")
    assert not compare(nowhere, kg.build(nowhere, on_status="ignore"), states=50).passed


def test_kinks_are_approached_from_both_sides() -> None:
    system = slide("max(x.q, 0.3*y.p) + abs(sin(x.p))")
    found = special_states(system, random_states(system, 3))
    q, p, w = found.states.x[:, 0], found.states.x[:, 1], found.states.y[:, 1]
    assert found.at_rest == 5 and found.undefined == 0
    tail = slice(found.at_rest, None)
    between = np.abs(q - 0.3 * w)[tail] <= 4 * np.spacing(np.abs(q[tail]))
    assert between.sum() == 12  # from three states, by two variables, on two sides
    assert (np.abs(np.sin(p[tail][~between])) < 1e-15).all()


def test_kinks_of_expressions() -> None:
    text = "abs(x.q) + sign(2*y.q) + (min(t, 1, x.q) if x.q < 3 and not y.q >= 2 else max(1, 2))"
    assert [str(kink) for kink in kinks(kg.parse(text))] == [
        "x.q",
        "2.0 * y.q",
        "x.q - 3.0",
        "y.q - 2.0",
        "t - 1.0",
        "min(t, 1.0) - x.q",
        "1.0 - 2.0",
    ]
