"""The gallery: a moving picture of every model in models/, and the page docs/gallery.md that shows them.

`make gallery` runs this module. The motions are those of the generated C, so that a change of the equations
shows in the pictures.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.linalg import solve_continuous_are

import kanegen as kg
from kanegen.model.arguments import Floats
from kanegen.simulation import Trajectory
from kanegen.viewer.making import scene_of
from website.moving_picture import Camera, moving_svg

ROOT = Path(__file__).parents[2]
FRAMES = 60
"""Frames in a second, of which a picture keeps those that it needs."""

Effort = Callable[[float, Floats, Floats], Floats]
Control = Callable[[kg.System, kg.Library], Effort]


@dataclass(frozen=True)
class Scene:
    """A motion of a model.

    Attributes:
        model: Name of its file in models/.
        words: A sentence about what moves.
        seconds: Length of the motion (s).
        x: Coordinates at the start that are not neutral, by name.
        y: Speeds at the start that are not zero, by name.
        control: What makes generalized forces as a function of time and state.
        prescribed: Values, rates and second derivatives of prescribed freedoms as a function of time.
        up: Direction that is up in the picture, inertial components.
        toward: Direction in which the viewer looks.
        height: Angle (rad) from which the viewer looks down.
        slowness: Seconds of the picture for a second of the motion.
        trace: Body and position (m) of a point whose path is drawn.
    """

    model: str
    words: str
    seconds: float
    x: dict[str, float] = field(default_factory=dict)
    y: dict[str, float] = field(default_factory=dict)
    control: Control | None = None
    prescribed: Callable[[float], Floats] | None = None
    up: tuple[float, float, float] = (0, 0, 1)
    toward: tuple[float, float, float] = (0, 1, 0)
    height: float = 0.0
    slowness: float = 1.0
    trace: tuple[str, tuple[float, float, float]] | None = None


def balanced(weights: tuple[float, ...], acting: int) -> Control:
    """Return the control that a linear-quadratic regulator about rest gives to one freedom."""

    def control(system: kg.System, library: kg.Library) -> Effort:
        n = len(system.freedoms)
        linear = kg.linearize(system, np.zeros(n), np.zeros(n))
        b = linear.B[:, [acting]]
        gains = b.T @ solve_continuous_are(linear.A, b, np.diag(weights), np.eye(1))
        return lambda t, x, y: np.eye(n)[acting] * -(gains @ np.concatenate([x, y])).item()

    return control


def along(path: Callable[[float], Floats]) -> Control:
    """Return the control by computed torques that keeps a robot on a path of its coordinates."""

    def control(system: kg.System, library: kg.Library) -> Effort:
        def effort(t: float, x: Floats, y: Floats) -> Floats:
            h = 1e-3
            before, now, after = path(t - h), path(t), path(t + h)
            rate, acceleration = (after - before) / (2 * h), (after - 2 * now + before) / h**2
            wanted = acceleration + 20 * (rate - y) + 100 * (now - x)
            return library.inverse_dynamics(x, y, wanted)

        return effort

    return control


def swinging(rate: float) -> Control:
    """Return the control by computed torques under which all freedoms swing with the same rate (rad/s)."""

    def control(system: kg.System, library: kg.Library) -> Effort:
        return lambda t, x, y: library.inverse_dynamics(x, y, -(rate**2) * x - 0.1 * rate * y)

    return control


def _driven(system: kg.System, library: kg.Library) -> Effort:
    """Return the forces of a crane whose bridge and trolley travel there and back on a rope of one length."""

    def effort(t: float, x: Floats, y: Floats) -> Floats:
        there = np.clip(t / 5, 0, 1) - np.clip((t - 8) / 5, 0, 1)
        wanted = 6 * (6 * there**5 - 15 * there**4 + 10 * there**3) * np.array([1.0, 0.6])
        forces = 2.0e4 * (wanted - x[2:4]) - 6.0e4 * y[2:4]
        hoist = -12000 * 9.81 * np.cos(x[0]) * np.cos(x[1]) - 4.0e5 * (x[4] - 9.0) - 2.0e5 * y[4]
        return np.array([0.0, 0.0, *forces, hoist])

    return effort


def _bump(t: float) -> Floats:
    """Return a road with a bump of 8 cm between 0.5 s and 0.8 s."""
    phase = (t - 0.5) / 0.3
    if not 0 < phase < 1:
        return np.zeros((3, 1))
    turn, rate = 2 * np.pi * phase, 2 * np.pi / 0.3
    return 0.04 * np.array([[1 - np.cos(turn)], [rate * np.sin(turn)], [rate**2 * np.cos(turn)]])


def _reaching(middle: list[float], swing: list[float], seconds: float) -> Control:
    """Return the control of a robot whose joints swing about a pose, each once or twice in a motion."""
    turns = 2 * np.pi / seconds * np.array([1 + i % 2 for i in range(len(middle))])
    return along(lambda t: np.array(middle) + np.array(swing) * np.sin(turns * t))


SCENES = (
    Scene(
        "double_pendulum",
        "Two point masses on rods, released at rest. The motion is chaotic.",
        8,
        {"q1": 2.0, "q2": 0.5},
        up=(-1, 0, 0),
        toward=(0, 0, -1),
        trace=("lower", (0.7, 0, 0)),
    ),
    Scene(
        "cart_pole",
        "A force on the cart, from a linear-quadratic regulator, brings the pole upright and the cart back.",
        5,
        {"pole": 0.5, "cart_position": 0.8},
        control=balanced((1.0, 1.0, 1.0, 1.0), 1),
    ),
    Scene(
        "cart_two_poles",
        "One force brings two poles of different lengths upright, twice as slow as it happens.",
        6,
        {"q1": 0.12, "q2": 0.05, "position": -0.4},
        control=balanced((0.1,) * 6, 2),
        slowness=2.0,
    ),
    Scene(
        "panda_arm",
        "Computed torques keep the joints on a path. The ellipsoids are the inertias of the robot's file.",
        8,
        {"panda_joint4": -1.9, "panda_joint6": 1.9},
        control=_reaching([0, 0, 0, -1.9, 0, 1.9, 0], [0.9, 0.3, 0.4, 0.3, 0.5, 0.4, 1.0], 8),
        toward=(-1, 0.5, 0),
        height=0.25,
        trace=("panda_link7", (0, 0, 0.21)),
    ),
    Scene(
        "six_revolute_arm",
        "An industrial arm with six hinges; computed torques again.",
        8,
        control=_reaching([0, -0.4, 0.4, 0, 0.6, 0], [0.9, 0.4, 0.5, 0.8, 0.7, 1.5], 8),
        x={"j2": -0.4, "j3": 0.4, "j5": 0.6},
        toward=(-0.4, 1, 0),
        height=0.2,
        trace=("flange", (0, 0, 0.25)),
    ),
    Scene(
        "scara",
        "Two hinges move the arm in a plane; a slide lowers the tool.",
        6,
        control=_reaching([0.2, 0.9, 0, -0.06], [0.7, 0.8, 1.0, 0.06], 6),
        x={"shoulder": 0.2, "elbow": 0.9, "quill.s3": -0.06},
        toward=(-0.3, 1, 0),
        height=0.6,
        trace=("tool", (0.03, 0, -0.21)),
    ),
    Scene(
        "furuta_pendulum",
        "The pendulum falls from upright and drives the arm, on which nothing acts.",
        6,
        {"pendulum": 0.3},
        {"arm_angle": 2.0},
        toward=(0.6, 1, 0),
        height=0.35,
        trace=("rod", (0, 0, 0.337)),
    ),
    Scene(
        "gantry_crane",
        "Bridge and trolley travel there and back; the load of 12 t swings on its rope.",
        16,
        {"rope_length": 9.0},
        control=_driven,
        toward=(0.5, 1, 0),
        height=0.2,
        trace=("load", (0, 0, 0)),
    ),
    Scene(
        "quarter_car",
        "A bump of 8 cm passes below the wheel, three times slower, and the car follows on its suspension.",
        2,
        prescribed=_bump,
        slowness=3.0,
    ),
    Scene(
        "satellite",
        "A bus, oriented by a quaternion, tumbles in weightlessness, and its panels swing on hinges.",
        10,
        {"left_drive": 0.4, "right_drive": -0.4},
        {"bus.omega1": 0.3, "bus.omega2": 0.2, "bus.omega3": 0.8},
        toward=(1, 1, 0),
        height=0.3,
        trace=("bus", (0.9, 0, 0.4)),
    ),
    Scene(
        "free_body",
        "A body tumbles in weightlessness: Euler's equations.",
        12,
        {"spacecraft.theta1": 0.1},
        {"spacecraft.theta1": 0.5, "spacecraft.theta3": 1.2},
        toward=(1, 1, 0),
        height=0.3,
        trace=("spacecraft", (0, 0, 0.8)),
    ),
    Scene(
        "spinning_top",
        "A top of 24 turns a second, eight times slower. Its axis is released at rest: the tip draws cusps.",
        1.2,
        {"top.theta1": 0.5},
        {"top.theta3": 150.0},
        slowness=8.0,
        height=0.5,
        trace=("top", (0, 0, 0.1)),
    ),
    Scene(
        "planar_pendulum",
        "Two rods, locked to a plane.",
        8,
        {"upper.theta3": 1.2, "lower.theta3": 0.4},
        up=(-1, 0, 0),
        toward=(0, 0, -1),
    ),
    Scene(
        "eight_body",
        "Eight bodies with six freedoms each. Computed torques let all 48 freedoms swing at one rate.",
        6,
        {"body1.theta1": 0.2, "body2.theta2": 0.4, "body7.theta1": -0.5, "body6.theta1": 0.6},
        {"body1.theta3": 2.0, "body2.theta3": -2.0, "body7.s1": 0.5, "body1.s3": 0.4},
        control=swinging(5.0),
        toward=(1, 0.3, 0),
        height=0.15,
    ),
    Scene(
        "front_of_eight",
        "The same eight bodies, of which three move and five are welded to them.",
        6,
        {"body1.theta1": 0.2, "body2.theta2": 0.4, "body3.theta1": 0.6},
        {"body1.theta3": 2.0, "body2.theta3": -2.0},
        control=swinging(5.0),
        toward=(1, 0.3, 0),
        height=0.15,
    ),
)
"""What the gallery shows, in this order."""


def simulated(scene: Scene) -> tuple[kg.System, kg.Library, Trajectory]:
    """Return the system of a scene, its library, and its motion with a state for every frame."""
    system = kg.load(ROOT / "models" / f"{scene.model}.toml")
    library = kg.build(system, ("forward_dynamics", "inverse_dynamics", "coordinate_rates", "body_poses"))
    times = np.linspace(0.0, scene.seconds, round(FRAMES * scene.seconds * scene.slowness) + 1)
    start = {**dict(zip(system.coordinate_names, system.neutral_coordinates, strict=True)), **scene.x}
    x = np.array([start[name] for name in system.coordinate_names])
    y = np.array([scene.y.get(name, 0.0) for name in system.speed_names])
    effort = scene.control(system, library) if scene.control else None
    step, prescribed = 2e-3 / scene.slowness, scene.prescribed
    return system, library, kg.simulate(library, x, y, times, step=step, effort=effort, prescribed=prescribed)


def picture(scene: Scene) -> str:
    """Return the moving picture of a motion."""
    system, library, motion = simulated(scene)
    driven = {"prescribed": motion.inputs["prescribed"]} if scene.prescribed else {}
    poses = library.body_poses(motion.x, **driven)
    rotations, origins = poses[..., :3, :], poses[..., 3, :]
    traces = []
    if scene.trace:
        k = [body.name for body in system.bodies].index(scene.trace[0])
        traces.append(origins[:, k] + np.asarray(scene.trace[1]) @ rotations[:, k])
    camera = Camera.of(scene.up, scene.toward, scene.height)
    seconds, title = scene.seconds * scene.slowness, f"{scene.model}: {scene.words}"
    return moving_svg(scene_of(system), seconds, rotations, origins, camera, traces, title)


def page() -> str:
    """Return the page that shows all pictures."""
    lines = [
        "# Gallery",
        "",
        "Every model in [models](../models), moved by its generated C. Bodies are the ellipsoids that have",
        "their mass and inertia. `make gallery` makes the pictures again.",
        "",
    ]
    for scene in SCENES:
        name = scene.model
        links = f"[model](../models/{name}.toml), [cost](models/{name}.md)"
        lines += [f"## {name}", "", f"![{scene.words}](gallery/{name}.svg)", "", f"{scene.words} {links}", ""]
    return "\n".join(lines[:-1]) + "\n"


def main() -> None:
    """Write the pictures and the page."""
    folder = ROOT / "docs" / "gallery"
    folder.mkdir(exist_ok=True)
    for scene in SCENES:
        (folder / f"{scene.model}.svg").write_text(picture(scene), encoding="utf-8")
    (ROOT / "docs" / "gallery.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
