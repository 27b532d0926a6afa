"""Errors, conditioning and bounds on numbers worked out by hand, and every error message."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import fields
from fractions import Fraction

import numpy as np
import pytest

import kanegen as kg
from kanegen.measure import truth
from kanegen.measure.truth.balls import arb, arb_mat, ctx, inverse
from kanegen.measure.truth.conditioning import scaled_condition_number
from kanegen.measure.truth.enclosure import Enclosure
from kanegen.measure.truth.errors import bits_lost, units
from kanegen.reference.states import States
from tests.support import systems

U = 2.0**-53


def exact(*values: float | arb) -> Enclosure:
    """Return exact numbers as an enclosure without radius."""
    return Enclosure(tuple(map(arb, values)), (len(values),), 200)


def rod(**changes: object) -> kg.System:
    """One hinge about axis 3; a point mass of 2 kg at 0.5 m; gravity 8 m/s^2 along axis 1."""
    numbers = {
        "connection": [0],
        "mass": [2.0],
        "inertia": [np.zeros((3, 3))],
        "mass_center": [[0.5, 0, 0]],
        "joint_position": [[0, 0, 0]],
        "free": systems.flags(1, ["theta3"]),
        "gravity": (8.0, 0, 0),
        "loads": True,
    }
    return kg.System.from_arrays(**(numbers | changes))


def test_normwise_and_componentwise() -> None:
    found = truth.errors(np.array([3.5, 4.0]), exact(3.0, 4.0), np.ones(2), U)
    assert found.normwise == pytest.approx(0.5 / 5)
    assert found.componentwise == pytest.approx(0.5 / 3)
    scaled = truth.errors(np.array([3.5, 40.0]), exact(3.0, 40.0), np.array([1.0, 0.1]), U)
    assert (scaled.normwise, scaled.componentwise) == pytest.approx((found.normwise, found.componentwise))


def test_zero_entries_count_as_one_rounding_of_the_largest() -> None:
    found = truth.errors(np.array([2.0**-60, 4.0]), exact(0.0, 4.0), np.ones(2), U)
    assert found.componentwise == 2.0**-60 / (4 * U)
    assert truth.errors(np.zeros(2), exact(0.0, 0.0), np.ones(2), U).normwise == 0.0
    assert truth.errors(np.ones(2), exact(0.0, 0.0), np.ones(2), U).normwise == math.inf


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_bits(dtype: type) -> None:
    one = dtype(1.0)
    three_up = np.nextafter(np.nextafter(np.nextafter(one, dtype(2)), dtype(2)), dtype(2))
    below = np.nextafter(one, dtype(0))
    least = np.nextafter(dtype(0), dtype(1))
    values = np.array([one, below, three_up, -0.0, -least, np.nan, np.inf], dtype)
    truths = np.array([1, 1, 1, 0, least, 1, 1], np.float64)
    whole = 8 * dtype().itemsize
    assert bits_lost(values, truths).tolist() == [0, 1, 2, 0, math.log2(3), whole, whole]
    found = truth.errors(values[:3], exact(1.0, 1.0, 1.0), np.ones(3), U)
    assert (found.bits, found.worst_bits) == (1.0, 2.0)


def test_a_result_that_is_not_finite_has_infinite_errors() -> None:
    found = truth.errors(np.array([1.0, np.nan]), exact(1.0, 1.0), np.ones(2), U)
    assert found == truth.StateErrors(math.inf, math.inf, 32.0, 64.0, math.inf, math.inf)


def test_enclosures() -> None:
    with ctx.workprec(200):
        third = Enclosure((arb(1) / 3, arb(2) ** -2000 / 3), (2,), 200)
        assert Enclosure((arb(1e-40, 1e-39),), (1,), 200).value == 0.0
    assert third.value.tolist() == [1 / 3, 0.0]
    assert Fraction(1 / 3) + Fraction(third.residue[0]) == pytest.approx(Fraction(1, 3), rel=2.0**-100)
    assert abs(third.fractions[0] - Fraction(1, 3)) < Fraction(1, 2**199)
    assert 0 < third.radius[0] < 2.0**-198
    assert third.radius[1] == 5e-324
    missed = Fraction(1, 3) - Fraction(1 / 3)
    assert missed < third.distance(np.array([1 / 3, 0.0]))[0] < float(missed) * (1 + 1e-8)
    assert third.is_narrow(np.ones(2), 2.0**-190, U)
    assert not third.is_narrow(np.ones(2), 2.0**-205, U)
    with pytest.raises(kg.ArrayError, match=r"values have shape \(3,\); expected \(2,\)"):
        third.distance(np.ones(3))


def test_units_make_one_kind_of_number() -> None:
    """From metres to millimetres the scaled numbers change by a common factor only."""
    system = systems.chain(2, ["theta1", "s2"])
    diagonal = np.array([0.5, 0.3, 2.0, 3.0])
    metres = units(system, diagonal)
    millimetres = units(system, diagonal * [1e6, 1e6, 1, 1])
    ratio = metres.acceleration / millimetres.acceleration
    assert ratio == pytest.approx([1e-3, 1e-3, 1, 1])
    assert metres.acceleration[0] == pytest.approx(math.sqrt(0.4 / 2.5))
    assert metres.of("mass_matrix").ravel() @ np.ones(16) == pytest.approx(metres.force.sum() ** 2)
    assert units(rod(), np.array([0.5])).acceleration == pytest.approx([math.sqrt(0.5)])


@pytest.mark.parametrize("scale", [1.0, 1e-30])
@pytest.mark.parametrize("near", [2.0**-1, 2.0**-80])
def test_scaled_condition_number(near: float, scale: float) -> None:
    """A matrix with ones on the diagonal and 1 - near beside it has the eigenvalues near and 2 - near."""
    with ctx.workprec(300):
        off = (1 - arb(near)) * arb(scale).sqrt()
        matrix = arb_mat([[arb(1), off], [off, arb(scale)]])
        assert scaled_condition_number(matrix, inverse(matrix)) == pytest.approx((2 - near) / near, rel=1e-12)
        singular = arb_mat([[1, 1], [1, 1]])
        assert scaled_condition_number(singular, inverse(singular)) == math.inf


def test_cancellation_of_the_right_hand_side() -> None:
    """The weight pulls with 8 N m, {tau} balances 6 N m of it, and a load may add 2 N m."""
    x, still = [-math.pi / 2], [0.0]
    assert truth.conditioning(truth.truth(rod(), x, still)).chi == pytest.approx(1)
    balanced = truth.truth(rod(), x, still, tau=[-6.0])
    assert balanced["forcing"].value == pytest.approx([8.0])
    assert balanced["forward_dynamics"].value == pytest.approx([4.0])
    assert truth.conditioning(balanced).chi == pytest.approx((8 + 6) / 2)
    loaded = truth.truth(rod(), x, still, tau=[-6.0], torque=[[0, 0, 2.0]])
    assert truth.conditioning(loaded).chi == pytest.approx((8 + 6 + 2) / 4)
    floating = truth.truth(rod(gravity=(0, 0, 0)), x, still)
    assert truth.conditioning(floating) == truth.Conditioning(1.0, math.inf, 1.0, 0.0)


def test_a_mass_that_folds_back_cancels_in_the_matrix() -> None:
    """Two links of about 1 m fold back, so that the mass at the end is 2^-10 m from the first axis."""
    system = kg.System.from_arrays(
        connection=[0, 1],
        mass=[0.0, 1.0],
        inertia=[np.zeros((3, 3))] * 2,
        mass_center=[[0, 0, 0], [1, 0, 0]],
        joint_position=[[0, 0, 0], [1 + 2.0**-10, 0, 0]],
        free=systems.flags(2, ["theta3"]),
    )
    folded = truth.conditioning(truth.truth(system, [0.0, math.pi - 1e-3], [0.0, 0.0]))
    spread = truth.conditioning(truth.truth(system, [0.0, 1.0], [0.0, 0.0]))
    assert 1 <= spread.formation < 4
    assert 1e5 < folded.formation < 1e6


def test_weight_that_hardly_pulls_cancels_in_the_forcing() -> None:
    """On an almost level slide only 2^-30 of a weight of 20 N acts along the axis; {tau} may be larger."""
    level = rod(free=systems.flags(1, ["s1"]), gravity=(10 * 2.0**-30, 0, -10), loads=False)
    assert truth.conditioning(truth.truth(level, [0.3], [0.0])).formation == pytest.approx(2.0**30)
    pulled = truth.truth(level, [0.3], [0.0], tau=[20.0])
    assert truth.conditioning(pulled).formation == pytest.approx(2)


def test_bounds() -> None:
    assert truth.bound(U, 3, 5.0, 7.0) == 4 * U * 5 * (12 + 7)
    assert truth.bound(U, 3, 5.0, 7.0, 2.0) == 2 * truth.bound(U, 3, 5.0, 7.0)
    assert truth.bound(U, 3, 5.0) == 4 * U * 5 * 12
    assert truth.bound(U, 3, 5.0, 0.01 / U) == math.inf
    assert truth.bound(U, 3, 5.0, 0.009 / U, 2.0) == math.inf


def test_a_measurement_is_within_its_bound_if_every_state_is() -> None:
    names = [field.name for field in fields(truth.Measurement)]
    good, bad = (tuple(2.0 if name == "normwise" else bound for name in names) for bound in (3.0, 1.0))
    for rows, within in (([good, good], True), ([good, bad], False), ([bad, bad], False)):
        assert truth.Measurement.from_rows(rows).within_bound == within


def test_fits() -> None:
    found = truth.fit([1.0, 2.0, 9.0, 5.0], [8.0, 4.0, 9.0, math.inf])
    assert (found.count, found.outside, found.median, found.largest) == (3, 1, 2.0, 4.0)
    assert found.high == pytest.approx(3.96)
    assert found.holds
    assert str(found) == "3 states, 1 beyond the bound's reach: median 2, 99 % below 4, largest 4 of 4"
    assert not truth.fit([1.1], [1.0]).holds
    with pytest.raises(kg.OptionError, match="nothing to fit"):
        truth.fit([1.0], [math.inf])


MISUSES = {
    r"x: expected real numbers of shape \(1,\), got float64 of shape \(2,\)": {"x": [0.0, 0.0]},
    r"y: expected real numbers of shape \(1,\), got complex128": {"y": [1j]},
    "tau: every number must be finite": {"tau": [math.nan]},
    r"force: expected real numbers of shape \(1, 3\)": {"force": [0, 0, 0]},
    "inverse_dynamics needs ydot": {"outputs": "inverse_dynamics"},
    "no exact result for 'body_poses', only for mass_matrix": {"outputs": "body_poses"},
    "no exact result for 'forces', only for mass_matrix": {"outputs": "forces"},
    "no output is asked for": {"outputs": ()},
    "unit_roundoff is 0; it must lie between 0 and 1": {"unit_roundoff": 0},
    "unknown parameter 'm'": {"parameters": {"m": 1.0}},
}


@pytest.mark.parametrize("message", MISUSES)
def test_arguments_that_are_refused(message: str) -> None:
    with pytest.raises(kg.KanegenError, match=message):
        truth.truth(**({"system": rod(), "x": [0.0], "y": [0.0]} | MISUSES[message]))


def test_a_singular_matrix() -> None:
    system = rod(mass_center=[[0, 0, 0.5]])
    with pytest.raises(kg.SingularError, match="singular in this state, to"):
        truth.truth(system, [0.3], [0.1])
    assert truth.truth(system, [0.3], [0.1], outputs="mass_matrix")["mass_matrix"].value == 0.0


class Refusing:
    """A library whose results are all NaN."""

    outputs = ("inverse_dynamics", "forward_dynamics")
    precision = storage = "double"

    @property
    def parameters(self) -> dict[str, float]:
        return {}

    def forward_dynamics(self, x: np.ndarray, *_: object, **__: object) -> np.ndarray:
        return np.full(x.shape, np.nan)


def test_outputs_without_exact_results_are_not_measured() -> None:
    states = States(np.array([[0.3]]), np.array([[1.0]]), None, None)
    library = kg.build(rod(), ("forcing", "kinetic_energy"))
    assert tuple(truth.measure(rod(), library, states)) == ("forcing",)
    energy = kg.build(rod(), "kinetic_energy")
    with pytest.raises(kg.OptionError, match="nothing to measure: of kinetic_energy"):
        truth.measure(rod(), energy, states)


def test_states_without_results_count_as_infinite_errors() -> None:
    states = States(np.array([[0.3], [0.4]]), np.array([[1.0], [2.0]]), None, None)
    (found,) = truth.measure(rod(), Refusing(), states).values()
    assert found.normwise.tolist() == [math.inf, math.inf]
    assert found.worst_bits.tolist() == [64.0, 64.0]
    assert not found.within_bound
    with pytest.raises(kg.ArrayError, match="inverse_dynamics needs ydot"):
        truth.measure(rod(), Refusing(), states, outputs="inverse_dynamics")
    with pytest.raises(kg.ArrayError, match=r"tau: expected shape \(2, 1\), got \(1,\)"):
        truth.measure(rod(), Refusing(), states, tau=[1.0])


def test_kanegen_needs_no_flint_but_says_what_truth_needs() -> None:
    code = (
        "import sys; sys.modules['flint'] = None; import kanegen\n"
        "try: from kanegen.measure import truth\n"
        "except kanegen.KanegenError as error: print(error)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    message = "the Python package python-flint is not installed (pip install 'kanegen[truth]')"
    assert result.stdout.strip() == message
