"""Exact results agree with textbooks and with each other; generated code keeps its bounds against them."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.measure import truth
from kanegen.measure.truth import certify, kane, newton_euler
from kanegen.measure.truth.balls import arb, ctx
from kanegen.measure.truth.certify import checked_state
from kanegen.measure.truth.tree import tree
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.couplings import random_couplings
from tests.support.high_precision import true_values

OUTPUTS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")
NOTHING = np.zeros((3, 3))
QUICK = ("-O0", "-ffp-contract=off")
"""Compiler flags that change no bit of the results and compile fast."""


def inputs(system: kg.System, seed: int) -> dict[str, np.ndarray]:
    """Return random x, y, tau, ydot and loads."""
    rng = np.random.default_rng(seed)
    n, loads = len(system.freedoms), (2, system.number_of_bodies, 3)
    values = dict(zip(("x", "y", "tau", "ydot"), rng.normal(size=(4, n)), strict=True))
    return values | dict(zip(("force", "torque"), rng.normal(size=loads), strict=True))


def with_parameters(system: kg.System, seed: int) -> kg.System:
    """Make the first body's mass, its locked values and two angles of its joint frame run-time parameters."""
    first, *others = system.bodies
    angles = (kg.Parameter("tilt", 0.3 + seed), 0.7, kg.Parameter("yaw", -1.1))
    locked = tuple(kg.Parameter(f"lock{i}", 0.1 * i + 0.2) for i in range(6))
    joint = replace(first.joint, orientation=angles, locked=locked)
    return replace(system, bodies=(replace(first, mass=kg.Parameter("m1", first.mass), joint=joint), *others))


@pytest.mark.parametrize("seed", range(16))
def test_both_algorithms_enclose_the_same_numbers(seed: int) -> None:
    """The last quarter of the trees has couplings."""
    rng = np.random.default_rng(seed)
    system = with_parameters(systems.random_system(rng, bodies=1 + seed % 6), seed)
    if seed >= 12:
        system = random_couplings(system, rng, share=0.5)
        assert system.couplings
    values = inputs(system, seed)
    found = truth.truth(system, **values, outputs=OUTPUTS, parameters={"m1": 0.7})
    x, y, ydot = values["x"], values["y"], values["ydot"]
    system = system.with_parameters({"m1": 0.7})
    with ctx.workprec(150):
        numbers = tree(system, checked_state(system, **values))
        first = kane.equations(numbers)
        assert first.A.overlaps(newton_euler.mass_matrix(numbers))
        assert first.f.overlaps(newton_euler.forcing(numbers))
        assert max(float(entry.rad()) for entry in (*first.A.entries(), *first.f.entries())) < 1e-38
    a = reference.mass_matrix(system, x)
    f = reference.forcing(system, x, y, values["force"], values["torque"])
    for name, expected in (("mass_matrix", a), ("forcing", f), ("inverse_dynamics", a @ ydot - f)):
        assert np.abs(found[name].value - expected).max() <= 1e-13 * (1 + np.abs(expected).max())
    required = a @ found["forward_dynamics"].value - f - values["tau"]
    assert np.abs(required).max() <= 1e-12 * np.abs(a).max() * np.abs(found["forward_dynamics"].value).max()


@pytest.mark.parametrize("seed", range(4))
def test_forty_digits_agree(seed: int) -> None:
    """Compare with the reference in 40 digits, on trees whose joint frames are not turned."""
    system = systems.random_system(np.random.default_rng(seed), 4, orientations=False, loads=True)
    states = random_states(system, 1, seed)
    expected = true_values(system.values(), states)
    found = truth.truth(system, states.x[0], states.y[0], force=states.force[0], torque=states.torque[0])
    with mpmath.workdps(40):
        for name in ("mass_matrix", "forcing"):
            pairs = zip(found[name].fractions, expected[name][0].ravel(), strict=True)
            for fraction, entry in pairs:
                difference = mpmath.mpf(fraction.numerator) / fraction.denominator - entry
                assert abs(difference) <= 1e-30 * np.abs(found[name].value).max()


def pendulum() -> kg.System:
    """Return a double pendulum of two point masses."""
    return kg.System.from_arrays(
        connection=(0, 1),
        mass=[1.1, 0.3],
        inertia=[NOTHING, NOTHING],
        mass_center=[[0.7, 0, 0], [1.3, 0, 0]],
        joint_position=[[0, 0, 0], [0.7, 0, 0]],
        free=systems.flags(2, ["theta3"]),
        gravity=(9.81, 0, 0),
    )


@pytest.mark.parametrize("seed", range(20))
def test_double_pendulum_to_the_last_bit(seed: int) -> None:
    x, y, tau = np.random.default_rng(seed).normal(size=(3, 2))
    found = truth.truth(pendulum(), x, y, tau)
    with mpmath.workdps(60):
        m1, m2, l1, l2, g = map(mpmath.mpf, (1.1, 0.3, 0.7, 1.3, 9.81))
        (q1, q2), (u1, u2) = map(mpmath.mpf, x), map(mpmath.mpf, y)
        pull, both = m2 * l1 * l2 * mpmath.cos(q2), mpmath.sin(q1 + q2)
        a = mpmath.matrix(
            [[(m1 + m2) * l1**2 + m2 * l2**2 + 2 * pull, m2 * l2**2 + pull], [m2 * l2**2 + pull, m2 * l2**2]]
        )
        swing = m2 * l1 * l2 * mpmath.sin(q2)
        weight = (m1 + m2) * g * l1 * mpmath.sin(q1) + m2 * g * l2 * both
        f = mpmath.matrix([swing * (2 * u1 * u2 + u2**2) - weight, -swing * u1**2 - m2 * g * l2 * both])
        ydot = mpmath.lu_solve(a, f + mpmath.matrix(list(tau)))
        assert found["mass_matrix"].value.ravel().tolist() == [float(entry) for entry in a]
        assert found["forcing"].value.tolist() == [float(entry) for entry in f]
        assert found["forward_dynamics"].value.tolist() == [float(entry) for entry in ydot]
        high, low = found["forward_dynamics"].value[0], found["forward_dynamics"].residue[0]
        assert abs(ydot[0] - mpmath.mpf(high) - mpmath.mpf(low)) <= 2.0**-72 * abs(high)


@pytest.mark.parametrize("seed", range(10))
def test_spinning_top_to_the_last_bit(seed: int) -> None:
    """Compare a symmetric top on its tip, with three angles, with the equations of the textbook."""
    m, h, i1, i3, g = 1.1, 0.7, 0.3, 0.2, 9.81
    top = kg.System.from_arrays(
        connection=(0,),
        mass=[m],
        inertia=[np.diag([i1, i1, i3])],
        mass_center=[[0, 0, h]],
        joint_position=[[0, 0, 0]],
        free=systems.flags(1, ["theta1", "theta2", "theta3"]),
        gravity=(g, 0, 0),
    )
    x, y = np.random.default_rng(seed).normal(size=(2, 3))
    found = truth.truth(top, x, y)
    with mpmath.workdps(60):
        m, h, i1, i3, g = map(mpmath.mpf, (m, h, i1, i3, g))
        u1, u2, u3 = map(mpmath.mpf, y)
        s2, c2 = mpmath.sin(x[1]), mpmath.cos(x[1])
        tip = i1 + m * h**2
        spin = i3 * (u3 + u1 * s2)
        a = [[tip * c2**2 + i3 * s2**2, 0, i3 * s2], [0, tip, 0], [i3 * s2, 0, i3]]
        f = [
            2 * (tip - i3) * u1 * u2 * s2 * c2 - i3 * u2 * u3 * c2,
            -tip * u1**2 * s2 * c2 + spin * u1 * c2 + m * g * h * c2,
            -i3 * u1 * u2 * c2,
        ]
        assert found["mass_matrix"].value.tolist() == [[float(entry) for entry in row] for row in a]
        assert found["forcing"].value.tolist() == [float(entry) for entry in f]


def test_joint_frames_are_the_nearest_rotations() -> None:
    """[R] is the rotation nearest to [C] where [C] = [R][S] with a symmetric [S] close to 1."""
    system = systems.random_system(np.random.default_rng(0), 6)
    given = system.values().joint_orientation
    with ctx.workprec(200):
        numbers = tree(system, checked_state(system, **inputs(system, 0)))
        for link, c in zip(numbers.links, given, strict=True):
            r = link.orientation
            unity = r.transpose() * r
            stretch = r.transpose() * truth.balls.square(c)
            assert unity.overlaps(truth.balls.identity(3))
            assert stretch.overlaps(stretch.transpose())
            assert max(float(entry.rad()) for entry in (*unity.entries(), *stretch.entries())) < 1e-55
            assert abs(float(stretch.det()) - 1) < 1e-14
        right_angle = truth.balls.square([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
        assert truth.balls.nearest_rotation(right_angle) == right_angle


@pytest.mark.parametrize("algorithm", ["mass_matrix", "forcing", "inverse_dynamics"])
def test_an_error_in_one_algorithm_is_caught(monkeypatch: pytest.MonkeyPatch, algorithm: str) -> None:
    right = getattr(newton_euler, algorithm)
    monkeypatch.setattr(newton_euler, algorithm, lambda *arguments: right(*arguments) * (1 + arb(2) ** -64))
    with pytest.raises(truth.DisagreementError, match="do not overlap"):
        truth.truth(pendulum(), [0.1, 0.2], [0.3, 0.4], ydot=[0.5, 0.6], outputs=OUTPUTS)


@pytest.mark.parametrize("unit_roundoff", [2.0**-24, 2.0**-53, 2.0**-300])
def test_the_precision_is_doubled_until_the_enclosures_are_narrow(
    monkeypatch: pytest.MonkeyPatch, unit_roundoff: float
) -> None:
    tried = []
    monkeypatch.setattr(certify, "first_precision", lambda *_: 20)
    monkeypatch.setattr(certify, "tree", lambda *arguments: tried.append(ctx.prec) or tree(*arguments))
    found = truth.truth(pendulum(), [0.1, 0.2], [0.3, 0.4], unit_roundoff=unit_roundoff)
    assert tried == [20 * 2**i for i in range(len(tried))]
    assert tried[-1] == found.bits
    assert -np.log2(unit_roundoff) + 20 <= found.bits <= 4 * (-np.log2(unit_roundoff) + 30)
    for result in found.outputs.values():
        assert (result.radius <= 2.0**-20 * unit_roundoff * np.abs(result.value)).all()
        assert (result.radius > 0).all()


@pytest.fixture(scope="module")
def eight() -> kg.Library:
    return kg.build(systems.eight_body(), outputs=OUTPUTS, flags=QUICK)


@pytest.mark.parametrize("delta", slow_except((1e-1, 1e-6, 1e-12), 1e-12))
def test_near_gimbal_lock(eight: kg.Library, delta: float) -> None:
    system = systems.eight_body()
    state = random_states(system, 1, 1)
    state = States(state.x, state.y, None, None)
    state.x[0, 1:24:3] = np.pi / 2 - delta
    found = truth.truth(system, state.x[0], state.y[0])
    condition = truth.conditioning(found)
    assert 1e3 < condition.kappa_s * delta**2 < 1e4  # grows as 1 / cos(theta2)^2
    measured = truth.measure(system, eight, state, outputs="forward_dynamics")["forward_dynamics"]
    assert measured.normwise[0] <= 1e-13
    assert measured.bound[0] == np.inf if delta < 1e-4 else measured.normwise[0] <= measured.bound[0]


def test_a_straight_chain_of_64_links() -> None:
    system = systems.chain(64)
    rng = np.random.default_rng(0)
    found = truth.truth(system, np.zeros(64), rng.normal(size=64), rng.normal(size=64))
    result = found["forward_dynamics"]
    assert (result.radius <= 2.0**-73 * np.maximum(np.abs(result.value), 2.0**-53 * result.value.max())).all()


def test_a_zero_that_is_not_exact_has_a_tiny_radius() -> None:
    """A link hangs straight down because two angles cancel, which no finite precision can show exactly."""
    system = replace(pendulum(), gravity=(9.81, 0.0, 0.0))
    first, second = system.bodies
    held = replace(first.joint, free=(False,) * 6, locked=(0, 0, 0.3, 0, 0, 0))
    system = replace(system, bodies=(replace(first, joint=held), second))
    found = truth.truth(system, [-0.3], [0.0])
    assert found["forcing"].value == 0.0
    assert found["forcing"].radius == 5e-324
    assert truth.conditioning(found).chi >= 1


def test_eight_bodies_keep_the_bound(eight: kg.Library) -> None:
    system = systems.eight_body()
    states = random_states(system, 4)
    tau, ydot = np.random.default_rng(0).normal(size=(2, *states.x.shape))
    measured = truth.measure(system, eight, states, tau, ydot)
    assert tuple(measured) == OUTPUTS
    for found in measured.values():
        assert found.within_bound
        assert (found.normwise > 0).all()
        assert (found.normwise < 1e-14).all()
        assert (found.bits <= found.worst_bits).all()
        assert (found.kappa_s >= 1).all()
        assert (found.chi >= 1).all()


@pytest.mark.parametrize("precision", slow_except(("double", "float"), "double"))
def test_the_bounds_fit_generated_code(precision: str) -> None:
    """Errors stay within the bounds, and come within a factor of a thousand of them."""
    trees = [systems.random_system(np.random.default_rng(20 + n), n) for n in (1, 2, 3)]
    pairs = [(tree, kg.build(tree, OUTPUTS, flags=QUICK, precision=precision)) for tree in trees]
    fits = truth.calibrate(pairs)
    assert tuple(fits) == OUTPUTS
    for found in fits.values():
        assert found.count + found.outside == 30
        assert found.outside <= 3
        assert found.holds
        assert 1e-3 < found.median < found.high <= found.largest


@pytest.mark.parametrize(
    "precision, error", [("double", 1e-11), pytest.param("float", 1e-2, marks=pytest.mark.slow)]
)
def test_a_wrong_coefficient_exceeds_the_bound(precision: str, error: float) -> None:
    """The library computes a tree whose last mass is slightly larger."""
    system = systems.chain(3, ["theta1"], loads=True)
    states = random_states(system, 2)
    tau, ydot = np.random.default_rng(0).normal(size=(2, *states.x.shape))
    last = system.bodies[-1]
    wrong = replace(system, bodies=(*system.bodies[:-1], replace(last, mass=last.mass * (1 + error))))
    library = kg.build(wrong, OUTPUTS, flags=QUICK, precision=precision)
    for found in truth.measure(system, library, states, tau, ydot).values():
        assert not found.within_bound
        assert not found.fit.holds


def test_parameters_of_the_library_count() -> None:
    system = with_parameters(systems.random_system(np.random.default_rng(3), 2), 3)
    states = random_states(system, 2)
    library = kg.build(system, flags=QUICK).with_parameters({"m1": 5.5})
    assert all(found.within_bound for found in truth.measure(system, library, states).values())
    assert tuple(truth.measure(system, library, states, outputs="forcing")) == ("forcing",)
    with pytest.raises(kg.OptionError, match="has no 'forward_dynamics'"):
        truth.measure(system, library, states, outputs="forward_dynamics")


@pytest.mark.parametrize("mass, length, time", [(2.0**200, 1.0, 1.0), (1.0, 2.0**-60, 2.0**40)])
def test_units_do_not_matter(mass: float, length: float, time: float) -> None:
    """Units that differ by powers of two give the same digits, also at very large angles."""
    arrays = systems.random_system(np.random.default_rng(1), 3, loads=False).values()
    system, scaled = (systems.from_values(a) for a in (arrays, systems.rescaled(arrays, mass, length, time)))
    x, y = random_states(system, 1, 2).x[0], random_states(system, 1, 3).x[0]
    is_angle = np.array([freedom.is_angle for freedom in system.freedoms])
    x[is_angle] *= 1e20
    lengths = np.where(is_angle, 1.0, length)
    found = truth.truth(system, x, y)
    other = truth.truth(scaled, x * lengths, y * lengths / time)
    forces = mass * length**2 / time**2 / lengths
    assert (other["forcing"].value == found["forcing"].value * forces).all()
    assert (other["forward_dynamics"].value == found["forward_dynamics"].value * lengths / time**2).all()
    plain, rescaled = truth.conditioning(found), truth.conditioning(other)
    assert replace(rescaled, terms=rescaled.terms / length * time**2) == plain


@pytest.mark.parametrize("module", ["balls", "enclosure", "tree", "kane", "newton_euler"])
def test_exact_results_share_nothing_with_the_reference_or_the_compiler(module: str) -> None:
    source = Path(truth.__file__).with_name(f"{module}.py").read_text(encoding="utf-8")
    imported = re.findall(r"^ *from (kanegen[\w.]*)", source, flags=re.MULTILINE)
    foreign = {name.split(".")[1] for name in imported} - {"errors", "measure", "model", "program"}
    assert not foreign
    assert {name for name in imported if name.startswith("kanegen.program")} <= {
        "kanegen.program.constants",
        "kanegen.program.precision",
    }
