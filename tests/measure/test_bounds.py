"""Proven bounds hold in every state that is looked for: at random, in corners, by hill climbs, with truth."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.c.formats import formats, uniform
from kanegen.c.sincos import SHARED, sincos_named
from kanegen.errors import KanegenError, OptionError
from kanegen.measure import truth
from kanegen.measure.bounds import InputBox, read_domain, statement
from kanegen.measure.bounds.approximation import largest_error
from kanegen.measure.bounds.arcs import Arcs
from kanegen.measure.bounds.intervals import Intervals
from kanegen.measure.bounds.reduction import reduction
from kanegen.measure.bounds.rounding import half_ulp
from kanegen.measure.bounds.sines import kanegen_sines
from kanegen.measure.truth.balls import arb
from kanegen.model.arrays import Floats
from kanegen.options import Variant
from kanegen.program.precision import DOUBLE, FLOAT, Precision
from kanegen.reference.states import random_states
from tests.support.bound_search import MARGIN, Search
from tests.support.cases import slow_except
from tests.support.orientation_trees import with_quaternions

MODELS = Path("models")
OUTPUTS = ("mass_matrix", "inverse_dynamics")
DOMAIN: dict = {"y": {"angles": [-2.0, 2.0]}, "ydot": {"angles": [-5.0, 5.0]}}
ONE_BODY = (
    'name = "arm"\n[[body]]\nname = "arm"\nconnection = "ground"\nmass = 1.0\n'
    'inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\njoint.free = ["theta3"]\n'
)


def model(name: str) -> kg.System:
    return kg.load(MODELS / f"{name}.toml")


def search(
    system: kg.System, table: dict, outputs: tuple[str, ...], variant: Variant | None = None
) -> Search:
    library = kg.build(system, outputs, tier=variant or Variant(), flags=("-O1", "-ffp-contract=off"))
    return Search(library, read_domain(table, system))


def ratios(found: Search, bounds: kg.Bounds, output: str, states: dict[str, Floats]) -> Floats:
    """Return the largest error of every entry over its bound; 0 where both are 0."""
    errors, limits = found.errors(output, states).max(axis=0), bounds[output].ravel()
    assert (errors[limits == 0] == 0).all()
    return errors / np.where(limits > 0, limits, 1.0)


# Intervals and arcs


def test_operations_on_intervals_enclose_exact_results() -> None:
    rng = np.random.default_rng(0)
    ends = np.sort(rng.normal(size=(2, 4, 500)) * 10.0 ** rng.integers(-8, 8, (2, 4, 500)), axis=0)
    ends[:, :, ::5] = np.round(ends[:, :, ::5])
    a, b = Intervals(ends[0, 0], ends[1, 0]), Intervals(ends[0, 1], ends[1, 1])
    for operation, exact in (
        (a + b, lambda u, v: u + v),
        (a.plus(b), lambda u, v: u + v),
        (a - b, lambda u, v: u - v),
        (a * b, lambda u, v: u * v),
        (a.times(b), lambda u, v: u * v),
    ):
        for k in range(500):
            pairs = itertools.product((a.low[k], a.high[k]), (b.low[k], b.high[k]))
            values = [exact(Fraction(float(u)), Fraction(float(v))) for u, v in pairs]
            assert Fraction(float(operation.low[k])) <= min(values)
            assert Fraction(float(operation.high[k])) >= max(values)


def test_sums_and_products_with_powers_of_two_stay_exact() -> None:
    two, odd = Intervals(np.array([-2.0]), np.array([2.0])), Intervals(np.array([-0.7]), np.array([0.7]))
    assert two.times(odd).high[0] == 1.4
    assert two.plus(two).high[0] == 4.0
    assert (odd * odd).high[0] > 0.7 * 0.7


@pytest.mark.parametrize("length", [1e-3, 0.2, 2.0, 5.0, 6.5])
def test_sine_and_cosine_together_have_the_range_of_samples(length: float) -> None:
    rng = np.random.default_rng(int(100 * length))
    starts = rng.uniform(-10, 10, 50)
    x, y = (np.sort(rng.normal(size=(2, 50)), axis=0) for _ in range(2))
    arcs = Arcs(starts, starts + length)
    found = arcs.combination(Intervals(*x), Intervals(*y))
    angles = starts + length * np.linspace(0, 1, 2001)[:, None]
    corners = [
        a * np.cos(angles) + b * np.sin(angles) for a, b in itertools.product((x[0], x[1]), (y[0], y[1]))
    ]
    low, high = np.min(corners, axis=(0, 1)), np.max(corners, axis=(0, 1))
    assert (found.low <= low + 1e-15).all() and (found.high >= high - 1e-15).all()
    assert (found.high - high <= 1e-5 * np.hypot(*np.abs([x, y]).max(axis=1))).all()  # of the grid of angles


# Sine and cosine


@pytest.mark.parametrize("precision", [DOUBLE, FLOAT])
def test_half_a_unit_bounds_the_rounding_error_of_all_smaller_numbers(precision: Precision) -> None:
    rng = np.random.default_rng(0)
    largest = 2.0 ** rng.uniform(-20, 20, 300)
    largest[::3] = 2.0 ** np.round(np.log2(largest[::3])) * (1 + rng.choice([0, 1e-9, 1e-12], 100))
    bounds = half_ulp(largest, precision)
    for most, bound in zip(largest, bounds, strict=True):
        numbers = most * np.concatenate([rng.uniform(0.4, 1, 200), [1.0]]).astype(np.longdouble)
        numbers *= 1 - np.longdouble(2.0**-62)
        assert np.abs(numbers - numbers.astype(precision.dtype)).max() <= bound * (1 + 1e-15)


@pytest.mark.parametrize("precision", [DOUBLE, FLOAT], ids=lambda precision: precision.name)
@pytest.mark.parametrize("name", slow_except(["shared", "polynomial-5", "polynomial-15"], "shared"))
def test_errors_of_kanegens_sines_stay_below_their_proven_bounds(
    name: str, precision: Precision, tmp_path: Path
) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(ONE_BODY)
    variant = Variant(precision=precision.name, sincos=name)
    library = kg.build(kg.load(path), ["body_poses"], tier=variant)
    sincos = sincos_named(name, precision)
    assert sincos is not None
    proven, limit = kanegen_sines(sincos), float(sincos.limit)
    rng = np.random.default_rng(1)
    near = np.pi / 2 * rng.integers(-60000, 60000, 2000) + rng.choice([0, 1e-9, 1e-3], 2000)
    angles = np.concatenate([rng.uniform(-0.785, 0.785, 4000), rng.uniform(-4, 4, 4000), near])
    angles = angles[np.abs(angles) <= limit].astype(precision.dtype).astype(np.float64)
    poses = library.body_poses(angles[:, None])[:, 0]
    with mpmath.workprec(160):
        exact = np.array([[mpmath.sin(mpmath.mpf(a)), mpmath.cos(mpmath.mpf(a))] for a in map(float, angles)])
        computed = np.array(
            [[mpmath.mpf(float(s)), mpmath.mpf(float(c))] for s, c in poses[:, [1, 0], [0, 0]]]
        )
        computed *= np.sign((computed * exact).astype(np.float64))
        errors = np.abs(computed - exact).astype(np.float64)
    point = Intervals(angles, angles)
    for column, is_sine in enumerate((True, False)):
        size = np.abs(exact[:, column]).astype(np.float64)
        assert (errors[:, column] <= proven.error(is_sine, point, size)).all()
    whole = Intervals(np.array([-limit]), np.array([limit]))
    assert errors.max() > 0.5 * proven.error(True, whole, np.ones(1))[0]  # proven, and not far from the truth


def test_the_shared_sine_is_proven_to_nine_tenths_of_the_last_place() -> None:
    for precision, sincos in SHARED.items():
        whole = Intervals(np.array([-1e4]), np.array([1e4]))
        assert kanegen_sines(sincos).error(True, whole, np.ones(1))[0] < 0.9 * precision.roundoff


def test_a_reduction_that_is_not_exact_is_refused() -> None:
    with pytest.raises(ArithmeticError, match="too many bits"):
        reduction(replace(SHARED[DOUBLE], limit="1e6"))


def test_differences_to_sine_and_cosine_are_largest_where_samples_say_so() -> None:
    sincos = SHARED[DOUBLE]
    with mpmath.workprec(200):
        z = [mpmath.mpf(k) / 4000 for k in range(1, 2468)]
        sizes = [
            mpmath.sqrt(v) ** 3
            * abs(
                mpmath.polyval(list(reversed(sincos.sine)), v)
                - (mpmath.sqrt(v) - mpmath.sin(mpmath.sqrt(v))) / mpmath.sqrt(v) ** 3
            )
            for v in z
        ]
    proven = largest_error(sincos.sine, 3, 1, 3, Fraction(2467, 4000))
    assert float(max(sizes)) <= proven < 1.2 * float(max(sizes))


# Bounds of models


CASES = [
    (name, size, precision)
    for name in ("double_pendulum", "scara", "panda_arm", "gantry_crane", "spinning_top", "satellite")
    for size in ("full", "small")
    for precision in ("double", "float")
]


def table(system: kg.System, size: str) -> dict:
    """The ranges of a case: whole turns, or 0.1 rad about 0."""
    found: dict = {name: dict(part) for name, part in DOMAIN.items()}
    kinds = {coordinate.unit for coordinate in system.coordinates}
    if "1" in kinds:
        found["x"] = {"quaternions": [0.4, 0.6]}  # away from length 0
    if size == "small" and "rad" in kinds:
        found["x"] = {**found.get("x", {}), "angles": [-0.1, 0.1]}
        if system.parameters:
            found["parameters"] = {p.name: [0.9 * p.value, 1.1 * p.value] for p in system.parameters[:1]}
    return found


@pytest.mark.parametrize(
    "case",
    slow_except(
        CASES,
        ("scara", "full", "float"),
    ),
    ids=" ".join,
)
def test_no_state_breaks_a_bound(case: tuple[str, str, str]) -> None:
    name, size, precision = case
    system = model(name)
    found = search(system, table(system, size), OUTPUTS, Variant(precision=precision))
    bounds = kg.bound(found.library, found.box)
    assert not bounds.unbounded
    for output in OUTPUTS:
        starts = [found.random(4000), found.corners(1000)]
        worst = max((ratios(found, bounds, output, states) for states in starts), key=np.max)
        entry = int(np.argmax(worst))
        starts.append(found.climbed(output, entry))
        for states in starts:
            assert (ratios(found, bounds, output, states) <= MARGIN).all()


@pytest.mark.parametrize(
    "name", slow_except(("double_pendulum", "scara", "panda_arm"), "double_pendulum", "scara")
)
def test_bounds_hold_against_certified_truth(name: str) -> None:
    system = model(name)
    found = search(system, dict(DOMAIN), OUTPUTS)
    bounds = kg.bound(found.library, found.box)
    states = found.random(6)
    for k in range(6):
        x, y, ydot = (states[part][k] for part in ("x", "y", "ydot"))
        exact = truth.truth(system, x, y, ydot=ydot, outputs=OUTPUTS)
        for output in OUTPUTS:
            row = {part: values[k : k + 1] for part, values in states.items()}
            computed = found.computed(output, row).ravel()
            for number, ball, limit in zip(
                computed, exact[output].balls, bounds[output].ravel(), strict=True
            ):
                assert abs(arb(float(number)) - ball) <= arb(float(limit))


def test_a_bound_holds_for_the_function_of_all_outputs() -> None:
    system = model("scara")
    found = search(system, dict(DOMAIN), OUTPUTS)
    bounds, states = kg.bound(found.library, found.box), found.random(3000)
    together = found.library.evaluate(states["x"], states["y"], ydot=states["ydot"])
    for output, computed in zip(OUTPUTS, together, strict=True):
        exact = found.exact(output, states).reshape(computed.shape)
        assert (np.abs(computed - exact).max(axis=0) <= MARGIN * bounds[output]).all()


def test_bounds_of_kinematics_and_energies_hold() -> None:
    system = model("panda_arm")
    outputs = (
        "kinetic_energy",
        "potential_energy",
        "momentum",
        "mass_center",
        "body_poses",
        "point_jacobians",
    )
    found = search(system, dict(DOMAIN), outputs)
    bounds = kg.bound(found.library, found.box)
    for output in outputs:
        assert (ratios(found, bounds, output, found.random(2000)) <= MARGIN).all()


def test_fixed_inputs_are_computed_not_bounded() -> None:
    system = model("double_pendulum")
    fixed = {"x": {"angles": 0.0}, "y": {"angles": 0.0}}
    bounds = kg.bound(kg.generate(system), fixed)
    assert bounds.largest["mass_matrix"] < 4 * 2.0**-53 * bounds.magnitudes["mass_matrix"].max()


def test_the_default_box_holds_all_unit_quaternions_and_no_short_ones() -> None:
    system = kg.load(MODELS / "satellite.toml").with_coordinates("quaternion")
    source = kg.generate(system, ["mass_matrix", "forcing", "body_poses"])
    box = read_domain(None, system)
    assert box.shortest == 0.5
    assert read_domain(statement.as_table(box), system).shortest == 0.5
    x = box.intervals(formats(source.variant))["x"]
    places = [place for place, name in enumerate(system.coordinate_names) if re.search(r"\.e[0-3]$", name)]
    low, high = x.low[places], x.high[places]
    states = random_states(system, 300, limits=system.limits)
    unit = states.x[:, places] / np.linalg.norm(states.x[:, places], axis=1)[:, None]
    unit = np.concatenate([unit, np.eye(4), -np.eye(4), [[0.5, -0.5, 0.5, -0.5]]])
    assert ((low <= unit[..., None]) & (unit[..., None] <= high)).all(axis=1).any(axis=1).all()
    assert (np.maximum(low, -high).max(axis=0) == 0.5).all()
    bounds = kg.bound(source, box)
    assert not bounds.unbounded
    states.x[:, places] = unit[:300]
    double, exact = kg.build(system), kg.build(system, precision="long double")
    for name, arguments in (("mass_matrix", (states.x,)), ("forcing", (states.x, states.y))):
        errors = np.abs(getattr(double, name)(*arguments) - getattr(exact, name)(*arguments)).max(axis=0)
        assert (errors.max() > 0) and (errors <= bounds[name]).all()


def test_quaternions_that_may_have_length_0_are_named() -> None:
    system = kg.load(MODELS / "satellite.toml").with_coordinates("quaternion")
    source = kg.generate(system, ["mass_matrix"])
    bounds = kg.bound(source, {"x": {"quaternions": [-1.0, 1.0]}})
    assert "the quaternion of body 'bus' may have length 0 in the box" in bounds.unbounded["mass_matrix"]
    about = {"x": {"quaternions": [-0.1, 0.1], system.coordinate_names[0]: [0.9, 1.0]}}
    assert kg.bound(source, about).largest["mass_matrix"] < 1e-12
    with pytest.raises(
        kg.OptionError, match=r"at exclude.quaternions 0.5 nothing of bus.e0 to bus.e3 is left"
    ):
        kg.bound(source, {"x": {"quaternions": [-0.1, 0.1]}, "exclude": {"quaternions": 0.5}})
    with pytest.raises(kg.OptionError, match="unknown key 'quaternions'"):
        kg.bound(kg.generate(model("double_pendulum")), {"exclude": {"quaternions": 0.5}})


# What has no bound, and what is refused


def test_a_divisor_that_may_be_zero_has_no_bound_and_a_name() -> None:
    system = kg.load(MODELS / "free_body.toml")
    bounds = kg.bound(kg.generate(system, ["coordinate_rates"], speeds="angular_velocity"))
    assert np.isinf(bounds.largest["coordinate_rates"])
    assert "may be 0 in the box" in bounds.unbounded["coordinate_rates"]
    away = kg.bound(
        kg.generate(system, ["coordinate_rates"], speeds="angular_velocity"), {"exclude": {"clearance": 0.1}}
    )
    assert not away.unbounded


def test_a_reason_names_quantities_and_freedoms_of_the_model() -> None:
    bounds = kg.bound(kg.generate(model("panda_arm"), ["regularity"]))
    assert re.search(
        r"the divisor A_\d_\d_\d \(entry of \[A\] after the elimination of freedom 'panda_joint\d'\) "
        r"of D_\di \(1 over the pivot of freedom 'panda_joint\d'\) may be 0 in the box",
        bounds.unbounded["regularity"],
    )
    wide = kg.bound(kg.generate(model("panda_arm"), ["mass_matrix"]), {"x": {"panda_joint2": [0.0, 1e7]}})
    assert "the angle x[1] ('panda_joint2') may be larger" in wide.unbounded["mass_matrix"]


def test_an_angle_beyond_the_proven_reduction_has_no_bound() -> None:
    bounds = kg.bound(kg.generate(model("double_pendulum")), {"x": {"angles": [0.0, 1e6]}})
    assert "angle" in bounds.unbounded["mass_matrix"]


def test_overflow_has_no_bound() -> None:
    source = kg.generate(model("double_pendulum"), precision="float")
    bounds = kg.bound(source, {"y": {"angles": [0.0, 1e25]}})
    assert "single precision" in bounds.unbounded["forcing"]
    assert "mass_matrix" not in bounds.unbounded


@pytest.mark.parametrize("variant", ["fast", "exact"])
def test_variants_without_bounds_are_refused(variant: str) -> None:
    with pytest.raises(OptionError, match="no bounds for"):
        kg.bound(kg.generate(model("double_pendulum"), tier=variant))


@pytest.mark.parametrize(
    ("domain", "message"),
    [
        ({"z": {}}, "unknown key 'z'"),
        ({"x": {"elbow": [0, 1]}}, "unknown key 'elbow'"),
        ({"y": {"angles": [1, 0]}}, "is inverted"),
        ({"parameters": {"m": "heavy"}}, "unknown key 'm'"),
        ({"exclude": {"clearance": 1.5}}, "is not below 1"),
        ({"x": {"angles": [0.0, float("inf")]}}, "not a finite number"),
        ({"force": {"all": [-1, 1]}}, "no body takes loads"),
        ({"prescribed": {}}, "no freedom is prescribed"),
        ({"x": {"angles": np.array([0.0, 1.0, 2.0])}}, "a range is"),
        ([1.0], r"\[1.0\] has no ranges"),
        (3, "3 has no ranges"),
        ("angles", "'angles' has no ranges"),
        ("x.angles = [0", "^domain:1: not valid TOML"),
    ],
)
def test_a_bad_domain_is_one_clear_error(domain: Any, message: str) -> None:
    with pytest.raises(KanegenError, match=message):
        kg.bound(kg.generate(model("double_pendulum")), domain)


@pytest.mark.parametrize("source", [None, 3, "x"])
def test_what_is_no_generated_code_is_one_clear_error(source: Any) -> None:
    with pytest.raises(OptionError, match="is not generated code"):
        kg.bound(source)


def test_a_system_has_to_be_built_first() -> None:
    unbuilt: Any = model("double_pendulum")
    with pytest.raises(OptionError, match=r"'double_pendulum' is no code yet\. Give kg.build\(system\)"):
        kg.bound(unbuilt)


def test_an_unknown_output_is_one_clear_error() -> None:
    bounds = kg.bound(kg.generate(model("double_pendulum")))
    with pytest.raises(OptionError, match=r"unknown output 'masses'\. Known are 'mass_matrix'"):
        bounds["masses"]


def test_the_box_of_another_system_is_refused() -> None:
    with pytest.raises(OptionError, match="one of system 'scara', whose inputs differ"):
        kg.bound(kg.generate(model("double_pendulum")), read_domain(None, model("scara")))


def test_ranges_are_lists_tuples_or_arrays(tmp_path: Path) -> None:
    system = model("double_pendulum")
    path = tmp_path / "box.TXT"
    path.write_text("x.angles = [-0.5, 1.0]")
    boxes = [
        read_domain({"x": {"angles": angles}}, system)
        for angles in ([-0.5, 1.0], (-0.5, 1.0), np.array([-0.5, 1.0], dtype=np.float32))
    ]
    for box in (*boxes, read_domain(path, system), read_domain("x.angles = [-0.5, 1.0]", system)):
        assert box.low["x"].tolist() == [-0.5, -0.5] and box.high["x"].tolist() == [1.0, 1.0]


@pytest.mark.parametrize("name", sorted(path.stem for path in MODELS.glob("*.toml")))
def test_the_table_of_a_box_is_read_as_the_same_box(name: str) -> None:
    system = model(name)
    first = system.coordinate_names[0]
    box = read_domain({"x": {first: [-0.5, 0.25]}, "exclude": {"clearance": 0.125}}, system)
    again = read_domain(statement.as_table(box), system)
    assert again.clearance == box.clearance
    for array, low in box.low.items():
        assert np.array_equal(again.low[array], low) and np.array_equal(again.high[array], box.high[array])
    zero = {array: np.full_like(low, 0.0) for array, low in box.low.items()}
    stated = statement.as_table(InputBox(system, zero, zero))
    lost = read_domain(stated, system)  # every element that has a range is in the table
    stated_arrays = zero.keys() - {"weights", "direction", "state_direction"}  # theirs are always the same
    assert not any(end[array].any() for end in (lost.low, lost.high) for array in stated_arrays)


def test_bounds_state_all_inputs_with_their_units() -> None:
    bounds = kg.bound(kg.generate(model("quarter_car"), ["mass_matrix"]), {"x": {"hub": [0.0, 0.5]}})
    text, plain = str(bounds), bounds.as_dict()
    assert "(kg m^2, kg m, kg)" in text and "  x: hub = [0, 0.5] m\n" in text
    assert "  y: hub, ride = [-3.13209, 3.13209] m/s\n" in text
    assert "  tau: hub, ride = 0 N\n" in text and "stiffness = 16000" in text
    assert "  prescribed: accelerations.height = [-9.81, 9.81] m/s^2\n" in text
    assert plain["box"]["x"]["hub"] == [0.0, 0.5] and plain["units of the box"]["y"]["ride"] == "m/s"
    assert plain["outputs"]["mass_matrix"]["unit"] == bounds.units["mass_matrix"]


def test_a_library_is_bounded_at_its_own_parameters() -> None:
    system = model("double_pendulum")
    library = kg.build(system, ("mass_matrix", "forcing"))
    heavy = library.with_parameters({"m1": 1e3, "l2": 50.0, "g": 900.0})
    bounds = kg.bound(heavy, DOMAIN)
    found = Search(heavy, read_domain(DOMAIN, system.with_parameters(heavy.parameters)))
    states = found.random(500)
    at_defaults = kg.bound(library, DOMAIN)
    for output in library.source.outputs:
        assert (ratios(found, bounds, output, states) <= MARGIN).all()
        assert (ratios(found, at_defaults, output, states) > 10).any()
    given = kg.bound(heavy, {**DOMAIN, "parameters": dict(library.parameters), "x": {"angles": [-1, 1]}})
    assert given.largest == kg.bound(library, {**DOMAIN, "x": {"angles": [-1, 1]}}).largest


def test_inputs_that_are_rounded_to_single_precision_stay_in_the_box() -> None:
    system = model("double_pendulum")
    box = read_domain({"x": {"angles": [0.1, 0.7]}}, system)
    ends = box.intervals(uniform(FLOAT))["x"]
    assert (ends.low[:, 0] <= float(np.float32(0.1))).all() and (ends.high[:, 0] >= 0.7).all()
    assert (ends.low.astype(np.float32) == ends.low).all() and (
        ends.high.astype(np.float32) == ends.high
    ).all()


def test_names_with_dots_stand_in_domains_as_they_are() -> None:
    """TOML takes the dots of `x.body1.e0` for tables in each other."""
    system = with_quaternions(1)
    name = next(name for name in system.coordinate_names if name.endswith(".e0"))
    speed = system.speed_names[0]
    text = f"x.{name} = [0.5, 1.0]; y.{speed} = 2.0"
    quoted = f'x."{name}" = [0.5, 1.0]; y."{speed}" = 2.0'
    box, same = (read_domain(one, system) for one in (text, quoted))
    place = system.coordinate_names.index(name)
    assert (box.low["x"][place], box.high["x"][place]) == (0.5, 1.0)
    assert box.low["y"][0] == box.high["y"][0] == 2.0
    for key, low in box.low.items():
        assert (low == same.low[key]).all()
        assert (box.high[key] == same.high[key]).all()
    body = name.partition(".")[0]
    with pytest.raises(OptionError, match=rf"unknown key '{body}\.e7'"):
        read_domain(f"x.{body}.e7 = 1", system)


def test_the_rounding_of_a_parameter_to_single_precision_counts() -> None:
    offset = kg.Joint(position=(kg.Parameter("c", 0.1), 0, 0), free=(False, False, True, False, False, False))
    system = kg.System("arm", (kg.Body("arm", 0, 1.0, np.eye(3).tolist(), joint=offset),))
    library = kg.build(system, outputs=("body_poses",), precision="float")
    bounds = kg.bound(library)
    error = abs(Fraction(float(library.body_poses([0.0])[0, 3, 0])) - Fraction(0.1))
    assert error > 0
    assert error <= bounds["body_poses"][0, 3, 0] <= error * (1 + Fraction(1, 2**40))
    assert any("whose rounding to their precision counts" in one for one in bounds.assumptions)
    assert kg.bound(library.with_parameters({"c": 0.125}))["body_poses"][0, 3, 0] == 0


@pytest.mark.parametrize("variant", [Variant(precision="float"), Variant(storage="float")])
def test_the_rounding_of_inputs_with_one_value_counts(variant: Variant) -> None:
    """The exact value is that of the doubles in the domain, up to errors of double precision."""
    system = model("scara")
    names, freedoms = system.coordinate_names, system.freedom_names
    rng = np.random.default_rng(5)
    outputs = ["mass_matrix", "inverse_dynamics", "body_poses"]
    single = kg.build(system, outputs, tier=variant)
    double = kg.build(system, outputs)
    for _ in range(3):
        x, y, ydot = rng.uniform(-1.0, 1.0, (3, len(names)))
        values = {"x": (names, x), "y": (freedoms, y), "ydot": (freedoms, ydot)}
        domain = {key: dict(zip(of, map(float, value), strict=True)) for key, (of, value) in values.items()}
        bounds = kg.bound(single, domain)
        for name, arguments in (
            ("mass_matrix", (x,)),
            ("inverse_dynamics", (x, y, ydot)),
            ("body_poses", (x,)),
        ):
            errors = abs(getattr(single, name)(*arguments).astype(float) - getattr(double, name)(*arguments))
            assert (errors <= bounds[name] + 1e-14).all()
            assert errors.max() > 1e-9


def test_a_range_without_a_number_of_the_precision_is_refused() -> None:
    system = model("double_pendulum")
    narrow = {"x": {"angles": [0.1, 0.1 + 1e-12]}}
    with pytest.raises(
        OptionError, match=r"domain: x\[0\]: the range \[0\.1, .*holds no number of single prec"
    ):
        kg.bound(kg.generate(system, precision="float"), narrow)
    assert np.isfinite(kg.bound(kg.generate(system), narrow)["mass_matrix"]).all()
