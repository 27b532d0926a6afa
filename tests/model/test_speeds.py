"""Angular velocities as generalized speeds: options, names, and {xdot}."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.cli.app import app
from kanegen.model.coordinates import FREEDOMS
from kanegen.model.joint import Joint
from kanegen.studies.bench import BenchOptions, compare
from kanegen.symbolic.printing import render
from tests.support import systems
from tests.support.orientation_trees import ANGULAR_VELOCITY, angle_state, close, maps, mixed

pytest.importorskip("flint")

FULL_TURN = (True, True, True, False, False, False)


def crane() -> kg.System:
    """Return a slide, a ball joint on it, and a hinge with a name of its own."""
    rng = np.random.default_rng(4)
    free = [[name in names for name in FREEDOMS] for names in (("s1",), FREEDOMS[:3], ("theta2",))]
    system = systems.random_system(
        rng, 3, free=np.array(free), connection=(0, 1, 2), loads=False, name="crane"
    )
    hinge = replace(system.bodies[2], joint=replace(system.bodies[2].joint, name="elbow"))
    return replace(system, bodies=(*system.bodies[:2], hinge))


def test_names_and_units_say_what_the_speeds_are() -> None:
    rates, angular = crane(), crane().with_speeds(ANGULAR_VELOCITY)
    angles = ("body2.theta1", "body2.theta2", "body2.theta3", "elbow", "body1.s1")
    assert rates.freedom_names == angular.freedom_names == rates.speed_names == angles
    assert angular.speed_names == ("body2.omega1", "body2.omega2", "body2.omega3", "elbow", "body1.s1")
    assert rates.speeds_are_rates
    assert not angular.speeds_are_rates
    assert angular.with_speeds("angle_rates") == rates
    assert [body.joint.speeds for body in angular.bodies] == ["angle_rates", ANGULAR_VELOCITY, "angle_rates"]


def test_what_has_fewer_than_three_free_angles_is_refused() -> None:
    with pytest.raises(
        kg.ModelError, match=r'needs three free angles.*Free theta1, theta2 and theta3, or keep "angle'
    ):
        Joint(free=(True, True, False, True, True, True), speeds=ANGULAR_VELOCITY)
    with pytest.raises(
        kg.ModelError, match=r"joint speeds: 'rates' is unknown\. Did you mean 'angle_rates'?"
    ):
        Joint(free=FULL_TURN, speeds="rates")
    with pytest.raises(kg.OptionError, match=r"unknown speeds 'angular'\. Did you mean 'angular_velocity'?"):
        crane().with_speeds("angular")


def test_arrays_and_model_files_keep_them(tmp_path: Path) -> None:
    angular = mixed(2).with_speeds(ANGULAR_VELOCITY)
    assert systems.from_values(angular.values()).values().speeds == angular.values().speeds
    path = tmp_path / "tree.toml"
    angular.save(path)
    assert (
        path.read_text().count('joint.speeds = "angular_velocity"')
        == angular.values().speeds.count(ANGULAR_VELOCITY)
        > 0
    )
    assert kg.load(path) == angular


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            'speeds = "angular"',
            r"model.toml: body 'a': joint speeds: 'angular' is unknown. Did you mean 'angul",
        ),
        (
            'speeds = "angular_velocity"\nfree = ["theta1"]',
            r"body 'a': joint speeds: .* needs three free angles",
        ),
        ("speeds = 3", r"body 'a': joint speeds: 3 is unknown. Known are 'angle_rates', 'angular_velocity'."),
    ],
)
def test_errors_in_model_files(tmp_path: Path, line: str, message: str) -> None:
    path = tmp_path / "model.toml"
    path.write_text(
        f'[[body]]\nname = "a"\nconnection = 0\nmass = 1\ninertia = [1, 1, 1]\n[body.joint]\n{line}\n'
    )
    with pytest.raises(kg.ReadError, match=message):
        kg.load(path)


def test_one_keyword_everywhere() -> None:
    rates, angular = crane(), crane().with_speeds(ANGULAR_VELOCITY)
    assert kg.generate(rates, speeds=ANGULAR_VELOCITY).files == kg.generate(angular).files
    assert kg.generate(angular, speeds="angle_rates").files == kg.generate(rates).files
    assert kg.derive(rates, speeds=ANGULAR_VELOCITY).y == kg.derive(angular).y != kg.derive(rates).y
    library = kg.build(rates, ("coordinate_rates",), speeds=ANGULAR_VELOCITY)
    assert library.speed_names == angular.speed_names
    assert library.freedom_names == rates.freedom_names
    for function in (kg.derive, kg.generate, kg.build, kg.compare):
        with pytest.raises(kg.OptionError, match="unknown speeds 'omega'"):
            function(rates, speeds="omega")
        with pytest.raises(kg.OptionError, match="5 is no System"):
            function(5, speeds=ANGULAR_VELOCITY)


def test_the_files_say_it(tmp_path: Path) -> None:
    source = kg.generate(crane(), ("forcing", "coordinate_rates"), speeds=ANGULAR_VELOCITY)
    header, readme = source.files["crane.h"], source.files["README.md"]
    assert "[A]{ydot} = {f},   {xdot} from {y} by Eq. (9), coordinate_rates\n" in header
    assert "0  body2.theta1  rad;  in y body2.omega1\n" in header
    assert "3  elbow  rad\n" in header
    assert "int crane_coordinate_rates(const double x[5], const double y[5], double xdot[5]);" in header
    assert "of a freedom whose squared divisor of Eq. (9) is not positive or NaN;" in header
    assert "| 0 | `body2.theta1`, in `y` `body2.omega1` | rad | rad/s |" in readme
    assert "the angles have no rates there" in readme
    assert "/* body2.omega1 */" in source.files["main.c"]
    assert "omegahat_K_i" in source.files["crane.c"]
    rates = kg.generate(crane(), ("forcing", "coordinate_rates"))
    assert "{xdot} = {y}\n" in rates.files["crane.h"]
    assert "int crane_coordinate_rates(" in rates.files["crane.h"]
    assert "omega1" not in "".join(rates.files.values())


@pytest.mark.parametrize("seed", [0, 3])
def test_rates_of_the_coordinates_in_c(seed: int) -> None:
    system = mixed(seed).with_speeds(ANGULAR_VELOCITY)
    library = kg.build(system, ("coordinate_rates",))
    given = [angle_state(system, i) for i in range(5)]
    expected = np.array([maps(system, values)[2] for values in given])
    x, y = (np.array([values[name] for values in given]) for name in "xy")
    close(library.coordinate_rates(x, y), expected)
    close(library.coordinate_rates(x[2], y[2]), expected[2])
    with pytest.raises(kg.OptionError, match="was built without the output 'forcing'"):
        library.forcing(x, y)


def test_where_there_are_no_rates() -> None:
    """At gimbal lock the status names the middle angle; [A] and {ydot} exist nevertheless."""
    system = crane().with_speeds(ANGULAR_VELOCITY)
    library = kg.build(system, ("forward_dynamics", "coordinate_rates"))
    x, y = np.full((3, 5), 0.3), np.ones((3, 5))
    x[1, 1] = np.nan
    with pytest.raises(
        kg.SingularError,
        match=r"^coordinate_rates: the squared divisor of Eq. \(9\) at freedom 'body2.theta2, body2.omega2' "
        "of body 'body2' is not positive or is NaN: x.1. is nan",
    ):
        library.coordinate_rates(x[1], y[1])
    with pytest.warns(
        kg.KanegenWarning,
        match=r"^coordinate_rates: in 1 of 3 states .* in state 1 the squared divisor of Eq. \(9\)",
    ):
        found = library.coordinate_rates(x, y)
    assert np.isnan(found[1]).all()
    assert np.isfinite(found[[0, 2]]).all()
    turned = replace(system.bodies[1].joint, sequence="3-1-3")
    bodies = (system.bodies[0], replace(system.bodies[1], joint=turned), system.bodies[2])
    euler = kg.build(replace(system, bodies=bodies), ("forward_dynamics", "coordinate_rates"))
    x[1, 1] = 0.0  # where sin(theta2) is 0, exactly
    with pytest.raises(kg.SingularError, match=r"body2.omega2' of body 'body2' is not positive"):
        euler.coordinate_rates(x[1], y[1])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isfinite(euler.forward_dynamics(x, y)).all()


@pytest.mark.parametrize("form", ["text", "latex", "python", "markdown"])
def test_equations_to_read(form: str) -> None:
    top = kg.load("models/spinning_top.toml")
    text = render(kg.derive(top, speeds=ANGULAR_VELOCITY), form)
    assert "by Eqs. (9), (45)" in text
    assert "omega1" in text
    if form == "python":
        module: dict[str, object] = {}
        exec(text, module)  # what was just printed
        given = angle_state(top.with_speeds(ANGULAR_VELOCITY))
        close(
            module["coordinate_rates"](given["x"], given["y"]),
            maps(top.with_speeds(ANGULAR_VELOCITY), given)[2],
        )
    else:
        assert ("thetadot_1_1 =" if form == "text" else r"\dot{\theta}_{1,1}") in text
    assert "by Eqs. (9), (45)" not in render(kg.derive(top), form)


def test_blocks_have_no_angle_rate_matrix() -> None:
    named = render(kg.derive(systems.chain(3, FREEDOMS[:3]), speeds=ANGULAR_VELOCITY))
    _, row = named.split("[ω'_2,y1] = ", 1)
    assert row.splitlines()[1].split("=", 1)[1].split("  ")[0].strip() == "[[^1R_2], [I], [0]]"
    assert "P̂" not in named


def test_a_contest_wants_rates() -> None:
    with pytest.raises(kg.OptionError, match=r'crane.*Take system.with_speeds\("angle_rates"\)'):
        compare(crane().with_speeds(ANGULAR_VELOCITY), BenchOptions(4, 1, 0.0))


def test_command_line(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "crane.toml"
    crane().save(path)
    for arguments, expected in (
        (["info", str(path)], "body2.omega1"),
        (["check", str(path), "--states", "20"], "passed over 20"),
        (["equations", str(path)], "omegahat_2_1"),
        (["generate", str(path), "-o", str(tmp_path / "out")], "wrote crane.h"),
    ):
        app([*arguments, "--speeds", ANGULAR_VELOCITY], standalone_mode=False)
        assert expected in capsys.readouterr().out, arguments
