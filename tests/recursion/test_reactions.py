"""Reaction loads: against the tree with nothing locked, results by hand, and the rate of momentum."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.model.arrays import FrameArrays
from kanegen.model.coordinates import ANGLES, FREEDOMS, SEQUENCES, TRANSLATIONS, Freedom
from kanegen.program.count import count
from kanegen.reference.kinematics import kinematics
from kanegen.studies.explain import cost_report
from kanegen.studies.explain.general_form import steps, with_all_freedoms, with_numbers_as_parameters
from tests.support import moving_bodies, systems
from tests.support.cases import slow_among
from tests.support.orientation_trees import ANGULAR_VELOCITY, mixed, quaternion_state, with_quaternions
from tests.support.paths import MODELS
from tests.support.reactions import efforts, reactions, unlocked

WARNINGS = "-O1 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror"

ROUNDING = 1e-13
"""Share of the largest effort: some hundred terms are summed in two orders, each rounded by 1e-16."""


def require_right(system: kg.System, seed: int) -> None:
    given = quaternion_state(system, seed)
    every = efforts(system, given)
    expected = np.array([every[row.freedom] for row in system.reaction_rows])
    size = max(map(abs, every.values()))
    assert reactions(system, given) == pytest.approx(expected, abs=ROUNDING * size)


def turned(seed: int, bodies: int = 5, **choices: object) -> kg.System:
    """Return a random tree in which every joint has its own sequence of axes."""
    rng = np.random.default_rng(seed)
    tree = systems.random_system(rng, bodies, **choices)  # type: ignore[arg-type]
    joints = (replace(body.joint, sequence=str(rng.choice(list(SEQUENCES)))) for body in tree.bodies)
    return replace(tree, bodies=tuple(replace(b, joint=j) for b, j in zip(tree.bodies, joints, strict=True)))


def freed(names: str) -> np.ndarray:
    return systems.flags(5, names.split())


def pulled(seed: int) -> kg.System:
    """Return a random tree with force elements along free and locked directions."""
    system, rng = turned(seed), np.random.default_rng(seed)
    freedoms = [f"{body.name}.{freedom}" for body in system.bodies for freedom in FREEDOMS]
    springs = (kg.JointSpring(name, *rng.uniform(1.0, 9.0, 2), damping=3.0) for name in freedoms[::2])
    drives = (kg.Drive(name, f'2 + x["{name}"]') for name in freedoms[::3])
    potential = kg.Potential(f'3*x["{freedoms[3]}"]**2 * x["{freedoms[7]}"]')
    return replace(system, force_elements=(*springs, *drives, potential))


TREES = {
    "anything": turned,
    "locked at zero": lambda seed: turned(seed, locked=False, orientations=False),
    "hinges": lambda seed: turned(seed, locked=False, free=freed("theta2"), orientations=seed > 0),
    "hinges turned by locked angles": lambda seed: turned(seed, free=freed("theta2")),
    "slides": lambda seed: turned(seed, free=freed("s1 s3")),
    "welded": lambda seed: turned(seed, free=np.arange(30).reshape(5, 6) == 12, connection=(0, 1, 2, 3, 2)),
    "angular velocities": lambda seed: mixed(seed).with_speeds(ANGULAR_VELOCITY),
    "quaternions": with_quaternions,
    "force elements": pulled,
    "parameters": lambda seed: with_numbers_as_parameters(turned(seed, 3)),
}


@pytest.mark.parametrize("kind", slow_among(TREES, "parameters", "slides", "hinges", "welded"))
def test_they_are_efforts_of_the_same_tree_with_nothing_locked(kind: str) -> None:
    for seed in range(3):
        require_right(TREES[kind](seed), seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100))
def test_a_hundred_random_trees(seed: int) -> None:
    system = turned(seed, 1 + seed % 7, locked=bool(seed % 3), orientations=bool(seed % 2))
    if system.reaction_rows:
        require_right(system, seed)


def test_the_pivot_of_a_pendulum() -> None:
    """A point mass on a massless rod swings in a plane 0.2 m before its pivot."""
    m, length, ahead, g = 2.0, 0.7, 0.2, 9.81
    hinge = kg.Joint(free=tuple(name == "theta3" for name in FREEDOMS))
    bob = kg.Body("bob", 0, m, np.zeros((3, 3)), (0.0, -length, ahead), hinge)
    system = kg.System("pendulum", (bob,), (0.0, -g, 0.0))
    assert system.reaction_names == ("bob.theta1", "bob.theta2", "bob.s1", "bob.s2", "bob.s3")
    angle, rate, up = 0.4, 3.0, -5.0
    s, c = np.sin(angle), np.cos(angle)
    force = m * np.array([length * (up * c - rate**2 * s), length * (up * s + rate**2 * c) + g, 0.0])
    moment = np.cross([length * s, -length * c, ahead], force)
    found = reactions(system, {"x": np.array([angle]), "y": np.array([rate]), "ydot": np.array([up])})
    assert found == pytest.approx([*moment[:2], *force], rel=1e-14)


def test_a_cantilever_at_rest() -> None:
    """Two welded beams with a slider at the end: each joint carries what lies beyond it, and nothing else."""
    masses, length, g = np.array([3.0, 2.0, 0.5]), 1.5, 10.0
    weld, slide = kg.Joint(free=(False,) * 6), (False, False, False, False, True, False)
    beam = kg.Body("root", 0, masses[0], np.eye(3), (length / 2, 0.0, 0.0), weld)
    outer = replace(beam, name="outer", lower=1, mass=masses[1], joint=replace(weld, position=(length, 0, 0)))
    end = kg.Body("end", 2, masses[2], np.eye(3), joint=kg.Joint((length, 0.0, 0.0), free=slide))
    system = kg.System("cantilever", (beam, outer, end), (0.0, 0.0, -g))
    system = system.with_reactions(["root.theta2", "root.s3", "outer.s3", "outer.theta2", "end.s3"])
    found = reactions(system, {name: np.zeros(1) for name in ("x", "y", "ydot")})
    weights, arms = g * masses, length * np.array([0.5, 1.5, 2.0])
    inner, lesser = -weights @ arms, -weights[1:] @ (arms[1:] - length)
    assert found == pytest.approx([inner, weights.sum(), weights[1:].sum(), lesser, weights[2]], rel=1e-14)


@pytest.mark.parametrize("seed", range(3))
def test_the_ground_changes_the_momentum(seed: int) -> None:
    """On a welded mount force and weight are the rate of momentum, the moment that of angular momentum."""
    rng = np.random.default_rng(seed)
    free = systems.random_free(rng, 5)
    free[0], free[1] = False, True
    system = systems.random_system(
        rng, 5, connection=(0, 1, 2, 2, 1), free=free, loads=False, orientations=False, locked=False
    ).with_reactions([f"body1.{name}" for name in FREEDOMS])
    given, arrays = quaternion_state(system, seed), system.values()
    x, y, ydot = (given[name] for name in ("x", "y", "ydot"))
    h = 1e-30  # of a complex step, which cancels nothing
    rate = moving_bodies.expected(arrays, x + 1j * h * y, y + 1j * h * ydot)["momentum"].imag / h
    found = reactions(system, given)
    moment, force = found[:3], found[3:]
    weight = arrays.mass.sum() * arrays.gravity
    arm = arrays.joint_position[0] - moving_bodies.expected(arrays, x, y)["mass_center"]
    turning = moment + np.cross(arm, force)
    assert np.array([*(force + weight), *turning]) == pytest.approx(rate, abs=1e-13 * np.abs(found).max())


def test_compiled_code() -> None:
    """One state and many give the same, alone and with other outputs, under other parameter values."""
    system = with_numbers_as_parameters(turned(4, 3, loads=True)).with_parameters({"number7": 0.5})
    library = kg.build(system, ("reaction_loads", "inverse_dynamics"), flags=WARNINGS)
    assert library.reaction_names == system.reaction_names
    given = [quaternion_state(system, seed) for seed in range(9)]
    x, y, ydot, force, torque = (
        np.array([one[name] for one in given]) for name in ("x", "y", "ydot", "force", "torque")
    )
    batch = library.reaction_loads(x, y, ydot, force, torque)
    assert batch.shape == (9, len(system.reaction_rows))
    together = library.evaluate(x, y, force, torque, ydot=ydot)
    size = np.abs(batch).max()
    assert together.reaction_loads == pytest.approx(batch, abs=ROUNDING * size)
    for row in range(9):
        one = library.reaction_loads(x[row], y[row], ydot[row], force[row], torque[row])
        assert one.tolist() == batch[row].tolist()
        every = efforts(system, given[row])
        expected = [every[row.freedom] for row in system.reaction_rows]
        assert one == pytest.approx(expected, abs=ROUNDING * max(map(abs, every.values())))
    other = library.with_parameters({"number7": 1.5}).reaction_loads(x[0], y[0], ydot[0], force[0], torque[0])
    expected = reactions(system.with_parameters({"number7": 1.5}), given[0])
    assert other == pytest.approx(expected, abs=ROUNDING * size)
    with pytest.raises(kg.OptionError, match="without the output 'body_poses'"):
        library.body_poses(x)


def test_selected_reactions_are_those_of_all_and_cost_less() -> None:
    system = turned(1, 5, loads=True)
    every, given = reactions(system, quaternion_state(system, 1)), quaternion_state(system, 1)
    names = (system.reaction_names[-1], system.reaction_names[2])
    some = system.with_reactions(names)
    assert some.reaction_names == names
    found = reactions(some, given)
    assert found == pytest.approx([every[-1], every[2]], abs=ROUNDING * np.abs(every).max())
    (all_of_them,) = compile_module(system, ("reaction_loads",)).module.functions.values()
    (few,) = compile_module(some, ("reaction_loads",)).module.functions.values()
    assert sum(count(few).values()) < sum(count(all_of_them).values())
    assert some.with_reactions(None) == system
    assert kg.generate(some).files == kg.generate(system).files


def test_the_header_documents_the_selection() -> None:
    system = kg.load(MODELS / "double_pendulum.toml").with_reactions(["lower.s2", "upper.theta1"])
    files = kg.generate(system, ("reaction_loads",)).files
    header, readme = files["double_pendulum.h"], files["README.md"]
    assert "0  lower.s2  N\n" in header
    assert "1  upper.theta1  N m\n" in header
    assert "DOUBLE_PENDULUM_REACTIONS" in header
    assert "| 1 | `upper.theta1` | N m |" in readme


def test_the_readme_says_what_the_loads_are() -> None:
    pendulum = kg.load(MODELS / "double_pendulum.toml").with_frames({"tool": ("lower", (0, 0, 1))})

    def about(*chosen: str) -> str:
        files = kg.generate(pendulum.with_reactions(chosen), ("reaction_loads",)).files
        return " ".join(files["README.md"].split())

    direction, component = "The load of an angle is the moment on the body about its origin", "of the frame"
    assert direction in about("upper.theta1")
    assert component not in about("upper.theta1")
    assert direction not in about("tool")
    assert "the moment on the body about the origin of the frame, and the force, in comp" in about("tool")
    assert "efforts on its freedoms included" in about("tool")
    assert direction in about("tool", "upper.theta1")
    assert component in about("tool", "upper.theta1")


def test_a_cost_report_compares_them_with_efforts() -> None:
    """Nothing is locked in the general program, so what holds a direction is an effort there."""
    system = kg.load(MODELS / "double_pendulum.toml").with_reactions(["lower.s2"])
    found = cost_report(system, ("reaction_loads", "body_poses"))
    (_, general), (_, locked), *_ = steps(system)
    assert general.reaction_names == with_all_freedoms(system).reaction_names == ()
    assert locked.reaction_names == ("lower.s2",)
    efforts = compile_module(general, ("inverse_dynamics", "body_poses"))
    assert found.steps[0].operations == efforts.operations
    assert found.steps[-1].total < found.steps[1].total < found.steps[0].total


def test_a_file_keeps_the_selection(tmp_path: Path) -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    system = system.with_poses([2]).with_reactions(["upper.s2", "lower.theta1"])
    system.save(tmp_path / "model.toml")
    assert kg.load(tmp_path / "model.toml") == system
    assert 'reaction_loads = ["upper.s2", "lower.theta1"]' in (tmp_path / "model.toml").read_text()


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["upper.theta3"], r"'upper.theta3' is free; its effort is what inverse_dynamics gives\. Lock it"),
        (["uper.theta1"], r"no locked direction or frame 'uper.theta1'\. Did you mean 'upper.theta1'\?"),
        ("upper.s4", r"no locked direction or frame 'upper.s4'\. Known are '"),
        (["upper.s1", "upper.s1"], r"reaction loads: 'upper.s1' is named twice"),
        ([], r"reaction loads: none is chosen\. Name one"),
        ([["upper.s1"]], r"there is no locked direction or frame \['upper.s1'\]"),
        (3, r"there is no locked direction or frame 3"),
    ],
)
def test_invalid_selections_are_refused(names: object, message: str) -> None:
    with pytest.raises(kg.ModelError, match=message):
        kg.load(MODELS / "double_pendulum.toml").with_reactions(names)  # type: ignore[arg-type]


def test_where_nothing_is_locked() -> None:
    system = systems.eight_body()
    with pytest.raises(kg.OptionError, match=r"'reaction_loads': system 'eight_body' has no locked dir"):
        kg.generate(system, ("reaction_loads",))
    with pytest.raises(kg.ModelError, match=r"reaction loads: no direction of a joint is locked\."):
        system.with_reactions(["body1.theta7"])


def wrenches(system: kg.System, given: dict[str, np.ndarray]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return for each body the moment about O_K and the force of its joint, in K, by virtual power.

    The efforts of the same tree with nothing locked do the power of the moment on the relative angular
    velocity and of the force on the velocity of the joint's translations.
    """
    every = efforts(system, given)
    whole, x = unlocked(system, given["x"], coordinates="angles")
    arrays = whole.values()
    found = []
    for k, body in enumerate(kinematics(arrays, x, 0 * x), start=1):
        angles, slides = (np.array([every[Freedom(k, i)] for i in part]) for part in (ANGLES, TRANSLATIONS))
        moment = np.linalg.solve(body.rate_matrix.T, angles)
        found.append((moment, body.relative_rotation @ arrays.joint_orientation[k - 1].T @ slides))
    return found


@pytest.mark.parametrize("seed", range(4))
def test_a_load_in_a_frame_is_all_that_the_joint_transmits(seed: int) -> None:
    """About the origin of the frame and in its components; a frame of a body for its users is the default."""
    rng = np.random.default_rng(seed)
    system = turned(seed, 4, free=np.delete(freed("theta2 s1"), 0, axis=0))
    names = [body.name for body in system.bodies]
    frames = {
        names[1]: (names[1], rng.normal(size=3), rng.normal(size=3)),
        "sensor": (names[2], rng.normal(size=3), rng.normal(size=3)),
    }
    system = system.with_frames(frames)
    assert f"{names[1]}.moment1" in system.reaction_names
    assert f"{names[1]}.theta1" not in system.reaction_names
    assert f"{names[0]}.theta1" in system.reaction_names
    chosen = system.with_reactions([names[1], "sensor", names[3], f"{names[0]}.s3"])
    given = quaternion_state(system, seed)
    found = reactions(chosen, given)
    joints = wrenches(system, given)
    expected = []
    for k, name in ((2, names[1]), (3, "sensor"), (4, "")):
        moment, force = joints[k - 1]
        frame = system.values().frames[name] if name else FrameArrays(k, np.zeros(3), np.eye(3))
        about = moment - np.cross(frame.position, force)
        expected += [*(frame.rotation @ about), *(frame.rotation @ force)]
    size = np.abs(expected).max()
    assert found[:-1] == pytest.approx(np.array(expected), abs=ROUNDING * size)
    assert found[-1] == pytest.approx(efforts(system, given)[Freedom(1, 5)], abs=ROUNDING * size)


def test_a_load_in_a_frame_includes_efforts_on_freedoms() -> None:
    """For given accelerations a spring at the hinge relieves the motor; the joint transmits the same."""
    system = kg.load(MODELS / "double_pendulum.toml").with_reactions(["upper"])
    given = quaternion_state(system, 1)
    sprung = system.with_force_elements(kg.JointSpring("q1", stiffness=30.0, damping=2.0))
    assert reactions(sprung, given) == pytest.approx(reactions(system, given), abs=1e-13)


@pytest.mark.parametrize(
    ("chosen", "message"),
    [
        (["table"], r"reaction loads: 'table' is fixed to the ground, below which there is no joint"),
        (["tool.moment4"], r"reaction loads: there is no locked direction or frame 'tool.moment4'"),
        (["tool", "tool.force1"], r"reaction loads: 'tool.force1' is named twice"),
        ([None], r"reaction loads: there is no locked direction or frame None"),
        (["upper.theta3"], r"'upper.theta3' is free"),
    ],
)
def test_invalid_loads_in_frames_are_refused(chosen: list[object], message: str) -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    system = system.with_frames({"tool": ("lower", (0, 0, 1)), "table": ("ground", (0, 0, 1))})
    with pytest.raises(kg.ModelError, match=message):
        system.with_reactions(chosen)  # type: ignore[arg-type]
