"""FMUs for FMI 2.0 and 3.0 in FMPy and CasADi: valid, the numbers of the library, and what attacks them."""

import itertools
import re
import shutil
import subprocess
import sys
from pathlib import Path

import casadi
import fmpy
import fmpy.build
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import kanegen as kg
from kanegen.artifacts.fmi.files import needed_outputs, usual_outputs
from kanegen.artifacts.fmi.names import dotted
from kanegen.errors import OptionError
from kanegen.library import load
from kanegen.model.arguments import LOADS
from kanegen.recursion.outputs import INTEGRATORS, available
from kanegen.reference.states import random_states
from tests.support import prescribed_trees
from tests.support.c_compilers import SANITIZERS, WARNINGS, C, run
from tests.support.cases import slow_except
from tests.support.fmu import CALL_FAILED, CO_SIMULATION, MODEL_EXCHANGE, Instance
from tests.support.pages import copy_of_checkout, fenced, run_console
from tests.support.paths import ROOT
from tests.support.random_trees import everything

HERE = Path(__file__).parent

VERSIONS = (2, 3)
KINDS = (MODEL_EXCHANGE, CO_SIMULATION)

KINDS_OF_TREES = prescribed_trees.KINDS[1:]

SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("panda_arm", "gantry_crane", "quarter_car")]
MODELS = ["double_pendulum", "satellite", *SLOW]


OWN_WARNINGS = [flag for flag in WARNINGS if flag != "-Wstrict-prototypes"]
"""Without that about declarations in the headers of FMI 3.0, which have functions without arguments."""


def system_of(name):
    return kg.load(ROOT / "models" / f"{name}.toml")


class Made:
    """FMUs of systems, and libraries of the same source, each made once."""

    def __init__(self, folder):
        self.folder, self.sources, self.libraries, self.paths = folder, {}, {}, {}

    def source(self, system):
        if system not in self.sources:
            self.sources[system] = kg.generate(system, artifacts=["fmi2", "fmi3"])
        return self.sources[system]

    def library(self, system):
        if system not in self.libraries:
            self.libraries[system] = load(self.source(system), on_status="ignore")
        return self.libraries[system]

    def fmu(self, system, version):
        if (system, version) not in self.paths:
            path = self.folder / f"{len(self.paths)}.fmu"
            self.paths[system, version] = kg.export(self.source(system), f"fmi{version}", path)
        return self.paths[system, version]

    def instance(self, system, version, kind=MODEL_EXCHANGE, **options):
        return Instance(self.fmu(system, version), kind, **options)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return Made(tmp_path_factory.mktemp("fmu"))


class Inputs:
    """Random inputs of a system in one state: as arrays of the library, and as variables of an FMU."""

    def __init__(self, system, library, seed=1):
        rng, state = np.random.default_rng(seed), random_states(system, 1, seed)
        self.system, self.model = system, library.source.model
        self.x, self.y = state.x[0], state.y[0]
        arrays = {array.name: array for one in library.source.functions for array in one.inputs}
        names = [*LOADS, "tau", "prescribed", "t"]
        self.further = {name: rng.standard_normal(arrays[name].shape) for name in names if name in arrays}
        for name in self.further.keys() & LOADS.keys():
            self.further[name][list(self.model.unloaded(LOADS[name]))] = 0.0
        self.arguments = {**self.further, "x": self.x, "y": self.y}

    def variables(self, is_fmi3):
        """Values by name of the variables, without the time."""
        speeds = self.model.speed_names or self.model.freedom_names
        found = {
            dotted("x", name): value for name, value in zip(self.model.coordinate_names, self.x, strict=True)
        }
        found |= {dotted("y", name): value for name, value in zip(speeds, self.y, strict=True)}
        if "tau" in self.further:
            found |= {dotted("tau", n): v for n, v in zip(speeds, self.further["tau"], strict=True)}
        for name in self.further.keys() & LOADS.keys():
            rows = {"body": self.model.body_names, "point": [p for p, _ in self.model.points]}[LOADS[name]]
            unloaded = self.model.unloaded(LOADS[name])
            for row, owner in enumerate(rows):
                if row not in unloaded:
                    found |= spread(dotted(name, owner), self.further[name][row], is_fmi3)
        for column, name in enumerate(self.model.prescribed_names):
            for row, label in enumerate(("value", "rate", "second_derivative")):
                found[f"{dotted('prescribed', name)}.{label}"] = self.further["prescribed"][row, column]
        return found


def spread(name, values, is_fmi3):
    """An array as one variable of FMI 3.0, or as a variable for each number."""
    if is_fmi3:
        return {name: values}
    places = itertools.product(*(range(length) for length in np.shape(values)))
    return {f"{name}[{','.join(str(i + 1) for i in place)}]": values[place] for place in places}


def initialized(made, system, version, inputs, kind=MODEL_EXCHANGE, **options):
    """An instance after Initialization Mode with these inputs."""
    one = made.instance(system, version, kind)
    one.initialize(inputs.variables(version == 3), time=float(inputs.further.get("t", 0.0)), **options)
    return one


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", MODELS)
def test_an_fmu_is_valid(made, name, version):
    assert validate_fmu(str(made.fmu(system_of(name), version))) == []


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", MODELS)
def test_all_outputs_have_the_bits_of_the_library(made, name, version):
    system = system_of(name)
    library = made.library(system)
    inputs = Inputs(system, library)
    with initialized(made, system, version, inputs) as one:
        assert np.array_equal(one.rates(), expected_rates(system, library, inputs))
        for output in ("kinetic_energy", "potential_energy", "point_positions", "point_velocities"):
            if output in library.source.outputs:
                arguments = {
                    a.name: inputs.arguments[a.name]
                    for a in function(library, output).inputs
                    if a.name in inputs.arguments
                }
                names = [name for name in one.variables if name.startswith(output)]
                assert np.array_equal(one.get(names), np.ravel(getattr(library, output)(**arguments)))
        assert one.log == []


def function(library, name):
    return next(one for one in library.source.functions if one.name == name)


def expected_rates(system, library, inputs):
    ydot = library.forward_dynamics(inputs.x, inputs.y, **inputs.further)
    further = {name: inputs.further[name] for name in ("prescribed", "t") if name in inputs.further}
    names = {
        array.name
        for one in library.source.functions
        if one.name == "coordinate_rates"
        for array in one.inputs
    }
    further = {name: value for name, value in further.items() if name in names}
    xdot = inputs.y if system.speeds_are_rates else library.coordinate_rates(inputs.x, inputs.y, **further)
    return np.concatenate([xdot, ydot])


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", MODELS)
def test_steps_of_co_simulation_have_the_bits_of_the_rollout(made, name, version):
    system = system_of(name)
    library = made.library(system)
    inputs = Inputs(system, library)
    if "prescribed" in inputs.further:
        inputs.further["prescribed"][1:] = 0.0  # or the rollout, which is told one row, would not follow it
    with initialized(made, system, version, inputs, CO_SIMULATION) as one:
        start = float(inputs.further.get("t", 0.0))
        for number in range(5):
            one.step(start + 0.01 * number, 0.01)
        names = [name for name in one.variables if name.startswith(("x.", "y."))]
        rollout = library.rollout(inputs.x, inputs.y, steps=50, step=1e-3, **inputs.further)
        found, expected = one.get(names), np.concatenate([rollout.x[-1], rollout.y[-1]])
        assert np.array_equal(found, expected) or (
            "t" in inputs.further and np.allclose(found, expected, 1e-12)
        )


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 3])
def test_random_trees_with_all_inputs_have_the_bits_of_the_library(made, seed):
    system = everything(seed, bodies=2).with_contacts([])
    outputs = (
        *needed_outputs(system),
        *usual_outputs(system),
        "frame_velocities",
        "reaction_loads",
        "momentum",
        "mass_matrix_inverse",
    )
    outputs = tuple(name for name in outputs if name in available(system) or name in INTEGRATORS)
    source = kg.generate(system, outputs, artifacts=["fmi2", "fmi3"])
    library = load(source, on_status="ignore")
    inputs = Inputs(system, library, seed)
    for version in VERSIONS:
        path = kg.export(source, f"fmi{version}", made.folder / f"random_{seed}_{version}.fmu")
        assert validate_fmu(str(path)) == []
        with Instance(path, MODEL_EXCHANGE) as one:
            one.initialize(inputs.variables(version == 3), time=float(inputs.further.get("t", 0.0)))
            assert np.array_equal(one.rates(), expected_rates(system, library, inputs))
            loads = known_names(one, ("force.", "torque.", "point_force.", "point_moment."))
            rates = known_names(one, "der(y.")
            seed_loads = np.random.default_rng(seed).standard_normal(one.size(loads))
            if loads:
                found = one.derivative(rates, loads, seed_loads)
                both = []
                for sign in (1.0, -1.0):
                    one.set(dict(zip_sizes(one, loads, sign * 1e6 * seed_loads)))
                    both.append(one.rates()[-len(rates) :])
                assert np.allclose(found, (both[0] - both[1]) / 2e6, rtol=1e-7, atol=1e-7)


def zip_sizes(one, names, numbers):
    """Names with their numbers."""
    first = 0
    for name in names:
        count = one.size([name])
        yield name, numbers[first : first + count]
        first += count


@pytest.mark.parametrize(
    "kind", [pytest.param(k, marks=pytest.mark.slow) for k in ("slides and hinges", *KINDS_OF_TREES)]
)
def test_prescribed_motion_is_followed_within_a_communication_step(made, kind):
    system = prescribed_trees.tree(kind, 2)
    library = made.library(system)
    inputs = Inputs(system, library)
    with initialized(made, system, 3, inputs, CO_SIMULATION) as one:
        assert np.array_equal(
            one.get(known_names(one, "der(y.")), expected_rates(system, library, inputs)[-len(inputs.y) :]
        )
        one.step(0.0, 0.01)
        value, rate, second = inputs.further["prescribed"]
        times = np.linspace(0.0, 0.01, 21)[:, None]
        rows = np.stack(
            [value + times * (rate + times * second / 2), rate + times * second, second + 0.0 * times], 1
        )
        further = {**inputs.further, "prescribed": rows}
        rollout = library.rollout(inputs.x, inputs.y, steps=10, step=1e-3, hold="quadratic", **further)
        expected = np.concatenate([rollout.x[-1], rollout.y[-1]])
        assert np.allclose(one.get(known_names(one, ("x.", "y."))), expected, rtol=1e-12, atol=1e-12)


def test_prescribed_motion_goes_on_over_communication_steps(tmp_path):
    """What is asked for after a step is that of one moment, and the motion does not jump back at the next."""
    inertia = tuple(map(tuple, np.eye(3).tolist()))
    slide = kg.Joint(free=(False,) * 6, prescribed=(False, False, False, True, False, False), name="slide")
    hinge = kg.Joint(free=(False, True, False, False, False, False), name="q")
    bodies = (
        kg.Body("cart", 0, 1.0, inertia, joint=slide),
        kg.Body("pole", 1, 1.0, inertia, mass_center=(0.0, 0.0, -1.0), joint=hinge),
    )
    system = kg.System("moved", bodies).with_points({"base": ("cart", (0.0, 0.0, 0.0))})
    source = kg.generate(system, ("forward_dynamics", "rollout_rk4", "point_positions"), artifacts=["fmi3"])
    value, rate, second = start = np.array([0.2, 1.0, -0.6])
    with Instance(kg.export(source, "fmi3", tmp_path / "moved.fmu"), CO_SIMULATION) as one:
        names = known_names(one, "prescribed.")
        one.initialize({"step": 0.05, **dict(zip(names, start, strict=True))})
        for number in range(4):
            one.step(0.25 * number, 0.25)
            t = 0.25 * (number + 1)
            expected = [value + rate * t + second * t**2 / 2, rate + second * t, second]
            assert np.allclose(one.get(names), expected, rtol=1e-14, atol=1e-14)
            base = one.get(["point_positions.base"])
            assert np.isclose(np.linalg.norm(base), expected[0], rtol=1e-14)
        whole = one.get(["x.q", "y.q"])
    with Instance(tmp_path / "moved.fmu", CO_SIMULATION) as one:
        one.initialize({"step": 0.05, **dict(zip(names, start, strict=True))})
        one.step(0.0, 1.0)
        assert np.allclose(one.get(["x.q", "y.q"]), whole, rtol=1e-12)
        assert abs(whole[0]) > 0.01


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("start", [0.0, 1e6, 1e9])
def test_a_communication_step_cannot_be_made_twice(made, version, start):
    with made.instance(system_of("double_pendulum"), version, CO_SIMULATION) as one:
        one.initialize({"x.q1": 0.5}, time=start)
        for number in range(3):
            one.step(start + 5e-4 * number, 5e-4)
            before = one.get(["x.q1", "y.q1"])
            with pytest.raises(CALL_FAILED):
                one.step(start + 5e-4 * number, 5e-4)
            assert "s is none: the time is" in one.log[-1][2]
            assert np.array_equal(one.get(["x.q1", "y.q1"]), before)


def known_names(one, prefixes):
    return [name for name in one.variables if name.startswith(prefixes)]


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", MODELS)
def test_directional_derivatives_by_states_forces_and_parameters_have_the_bits_of_the_library(
    made, name, version
):
    system = system_of(name)
    library = made.library(system)
    inputs = Inputs(system, library)
    with initialized(made, system, version, inputs) as one:
        knowns = known_names(one, ("x.", "y.", "tau.", "parameters."))
        rates = known_names(one, "der(y.")
        expected = library.forward_dynamics_derivatives(inputs.x, inputs.y, **inputs.further)
        found = [one.derivative(rates, knowns, seed) for seed in np.eye(len(knowns))]
        assert np.array_equal(np.array(found).T, expected)
        read = [array.name for array in function(library, "kinetic_energy_derivatives").inputs]
        energies = library.kinetic_energy_derivatives(
            **{name: inputs.arguments[name] for name in read if name in inputs.arguments}
        )
        by = known_names(one, ("x.", "y.", "parameters."))
        found = [one.derivative(["kinetic_energy"], by, seed)[0] for seed in np.eye(len(by))]
        assert np.array_equal(found, energies)
        assert np.array_equal(
            one.derivative(known_names(one, "x."), knowns, seed_of(knowns, "x.")), ones(one, "x.")
        )
        assert one.log == []


def seed_of(names, prefix):
    return np.array([float(name.startswith(prefix)) for name in names])


def ones(one, prefix):
    return np.ones(len(known_names(one, prefix)))


@pytest.mark.parametrize("version", VERSIONS)
def test_rates_of_a_quaternion_and_accelerations_by_loads_have_exact_derivatives(made, version):
    system = system_of("satellite")
    library = made.library(system)
    inputs = Inputs(system, library)
    terms = kg.build(system, ("mass_matrix", "forcing", "coordinate_rates_derivatives"))
    with initialized(made, system, version, inputs) as one:
        knowns = known_names(one, ("x.", "y."))
        found = [one.derivative(known_names(one, "der(x."), knowns, seed) for seed in np.eye(len(knowns))]
        assert np.array_equal(np.array(found).T, terms.coordinate_rates_derivatives(inputs.x, inputs.y))
        for load in ("force", "torque"):
            names = known_names(one, f"{load}.")
            seed = np.random.default_rng(3).standard_normal(one.size(names))
            zero, push = (np.zeros((system.number_of_bodies, 3)) for _ in range(2))
            push[
                [not row for row in (k in library.source.model.unloaded("body") for k in range(len(push)))]
            ] = seed.reshape(-1, 3)
            forces = {"force": zero, "torque": zero}
            difference = terms.forcing(inputs.x, inputs.y, **{**forces, load: push}) - terms.forcing(
                inputs.x, inputs.y, **forces
            )
            expected = np.linalg.solve(terms.mass_matrix(inputs.x), difference)
            rates = known_names(one, "der(y.")
            assert np.allclose(one.derivative(rates, names, seed), expected, rtol=1e-9, atol=1e-9)
            if version == 3:
                adjoint = [one.adjoint(rates, names, weights) @ seed for weights in np.eye(len(rates))]
                assert np.allclose(adjoint, expected, rtol=1e-9, atol=1e-9)
        assert np.array_equal(one.rates(), expected_rates(system, library, inputs))  # nothing was changed


@pytest.mark.parametrize("name", MODELS)
def test_adjoint_derivatives_are_the_transpose(made, name):
    system = system_of(name)
    with initialized(made, system, 3, Inputs(system, made.library(system))) as one:
        knowns = known_names(one, ("x.", "y.", "tau.", "parameters."))
        unknowns = known_names(one, ("der(", "kinetic_energy", "potential_energy", "x."))
        forward = np.array([one.derivative(unknowns, knowns, seed) for seed in np.eye(len(knowns))]).T
        adjoint = np.array([one.adjoint(unknowns, knowns, seed) for seed in np.eye(len(unknowns))])
        assert np.array_equal(forward, adjoint)


@pytest.mark.parametrize("version", VERSIONS)
def test_parameters_are_tuned_in_events_and_checked(made, version):
    system = system_of("double_pendulum")
    library = made.library(system)
    inputs = Inputs(system, library)
    with initialized(made, system, version, inputs) as one:
        one.fmu.enterEventMode()
        one.set({"parameters.m1": 2.0, "parameters.l2": 0.9})
        one.fmu.enterContinuousTimeMode()
        tuned = library.with_parameters({"m1": 2.0, "l2": 0.9})
        assert np.array_equal(one.rates()[2:], tuned.forward_dynamics(inputs.x, inputs.y, **inputs.further))
        one.fmu.enterEventMode()
        for value, words in ((-1.0, "not between 0 and inf"), (np.nan, "not finite"), (np.inf, "not finite")):
            with pytest.raises(CALL_FAILED):
                one.set({"parameters.l2": 0.1, "parameters.m1": value})
            status, category, message = one.log[-1]
            assert (status, category) == (2, "logStatusDiscard")
            assert message.startswith("parameters.m1 = ")
            assert words in message
        assert np.array_equal(one.get(["parameters.m1", "parameters.l2"]), [2.0, 0.9])  # neither was set
        one.set({"parameters.m2": 0.0})
        with pytest.raises(CALL_FAILED):
            one.rates()
        assert "prepare: a result is infinite or NaN" in one.log[-1][2]
        one.set({"parameters.m2": 0.5})
        assert np.array_equal(one.rates()[2:], tuned.forward_dynamics(inputs.x, inputs.y, **inputs.further))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("version", VERSIONS)
def test_states_are_stored_restored_and_serialised(made, version, kind):
    system = system_of("double_pendulum")
    inputs = Inputs(system, made.library(system))
    names = ["x.q1", "y.q2", "der(y.q1)", "kinetic_energy"]
    with initialized(made, system, version, inputs, kind) as one:
        before, state = one.get(names), one.state()
        store = one.fmu.serializeFMUState if version == 3 else one.fmu.serializeFMUstate
        restore = one.fmu.deserializeFMUState if version == 3 else one.fmu.deSerializeFMUstate
        put = one.fmu.setFMUState if version == 3 else one.fmu.setFMUstate
        data = store(state)
        for move in (lambda: put(state), lambda: put(restore(data))):
            one.set({"tau.q1": 5.0})
            if kind == CO_SIMULATION:
                one.step(0.0, 0.1)
            else:
                one.set_states(np.ones(4))
            assert not np.array_equal(one.get(names), before)
            move()
            assert np.array_equal(one.get(names), before)
        with pytest.raises(CALL_FAILED):
            restore(data[:-1])
        with pytest.raises(CALL_FAILED):
            restore(b"x" * len(data))
        assert "no state of this FMU" in one.log[-1][2]
        damaged = bytes(data[:39]) + b"\xff" * (len(data) - 39)
        one.set({"parameters.m1": 1.25})
        stored = bytes(store(one.state()))
        place = stored.index(np.float64(1.25).tobytes())
        impossible = [
            with_checksum(stored[:place] + np.float64(m1).tobytes() + stored[place + 8 :])
            for m1 in (np.nan, np.inf, -1.0)
        ]
        for attempt in (damaged, *impossible):
            with pytest.raises(CALL_FAILED):
                restore(attempt)
            assert "damaged state" in one.log[-1][2]
        assert with_checksum(stored) == stored
        (one.fmu.freeFMUState if version == 3 else one.fmu.freeFMUstate)(state)


def with_checksum(data):
    """A stored state with the checksum of its other bytes: FNV-1a, of 64 bits."""
    found = 14695981039346656037
    for byte in data[:-8]:
        found = (found ^ byte) * 1099511628211 % 2**64
    return data[:-8] + found.to_bytes(8, sys.byteorder)


@pytest.mark.parametrize("version", VERSIONS)
def test_a_stored_state_with_any_damaged_byte_is_refused(made, version):
    rng = np.random.default_rng(version)
    with made.instance(system_of("double_pendulum"), version) as one:
        one.initialize({"x.q1": 0.5})
        store = one.fmu.serializeFMUState if version == 3 else one.fmu.serializeFMUstate
        restore = one.fmu.deserializeFMUState if version == 3 else one.fmu.deSerializeFMUstate
        data = bytes(store(one.state()))
        for place in range(len(data)):
            damaged = bytearray(data)
            damaged[place] ^= 1 << rng.integers(8)
            with pytest.raises(CALL_FAILED):
                restore(bytes(damaged))
        assert len(one.log) == len(data)
        restore(data)


def test_instances_do_not_share_anything(made):
    system = system_of("double_pendulum")
    with made.instance(system, 2) as one, made.instance(system, 2, name="two") as two:
        one.initialize({"x.q1": 0.5, "parameters.m1": 3.0})
        two.initialize({"x.q1": -1.0})
        first = one.rates()
        two.rates()
        assert np.array_equal(one.rates(), first)
        assert one.get(["parameters.m1"]) == 3.0
        assert two.get(["parameters.m1"]) == 1.0


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("kind", KINDS)
def test_wrong_calls_end_in_an_error_and_a_message(made, version, kind):
    with made.instance(system_of("double_pendulum"), version, kind) as one:
        setter, getter = (
            (one.fmu.setFloat64, one.fmu.getFloat64) if version == 3 else (one.fmu.setReal, one.fmu.getReal)
        )
        attempts = [
            (lambda: getter([4711]), "no variable with value reference 4711"),
            (lambda: setter([2**32 - 1], [0.0]), "no variable with value reference"),
            (lambda: setter([0], [1.0]), "the independent" if version == 3 else "no variable with"),
            (lambda: one.set({"kinetic_energy": 1.0}), "is computed"),
            (lambda: one.set({"x.q1": np.nan}), "x.q1 = nan is not finite"),
            (one.fmu.exitInitializationMode, "cannot be called while the FMU has been instantiated"),
            (one.fmu.terminate, "cannot be called while the FMU has been instantiated"),
            (lambda: one.derivative(["der(y.q1)"], ["step"], [1.0]), "while the FMU has been instantiated"),
        ]
        attempts.append(
            (lambda: one.step(0.0, 0.1), "has been instantiated")
            if kind == CO_SIMULATION
            else (lambda: one.set_states(np.zeros(4)), "has been instantiated")
        )
        for attempt, words in attempts:
            with pytest.raises(CALL_FAILED):
                attempt()
            assert words in one.log[-1][2]
        one.initialize({"x.q1": 0.1}, stop=1.0)
        for attempt, words in (
            (lambda: one.set({"step": 1.0}), "step cannot be set now: it is a fixed parameter"),
            (lambda: one.derivative(["der(y.q1)"], ["step"], [1.0]), "no derivatives by the variable"),
        ):
            with pytest.raises(CALL_FAILED):
                attempt()
            assert words in one.log[-1][2]
        if kind == CO_SIMULATION:
            with pytest.raises(CALL_FAILED):
                one.set({"x.q1": 1.0})
            assert "x.q1 cannot be set now: it is a state" in one.log[-1][2]
            for time, length, words in (
                (0.0, -1.0, "a step of -1 s"),
                (0.0, 0.0, "a step of 0 s"),
                (0.0, np.nan, "a step of nan s"),
                (0.5, 0.1, "the time is 0 s"),
                (0.0, 2.0, "beyond the stop time 1 s"),
            ):
                with pytest.raises(CALL_FAILED):
                    one.step(time, length)
                assert words in one.log[-1][2]
            one.step(0.0, 1.0)
        assert len(one.log) == len(attempts) + 2 + 6 * (kind == CO_SIMULATION)


@pytest.mark.parametrize("version", VERSIONS)
def test_a_step_that_fails_keeps_the_last_state_and_says_why(made, version):
    with made.instance(system_of("double_pendulum"), version, CO_SIMULATION) as one:
        one.initialize({"x.q1": 0.1})
        one.step(0.0, 0.1)
        before = one.get(["x.q1", "x.q2", "y.q1", "y.q2"])
        one.set({"tau.q1": 1e305})
        with pytest.raises(CALL_FAILED):
            one.step(0.1, 0.1)
        assert one.log[-1][:2] == (2, "logStatusDiscard")
        assert "step_rk4: a result is infinite or NaN" in one.log[-1][2]
        assert np.array_equal(one.get(["x.q1", "x.q2", "y.q1", "y.q2"]), before)
        one.set({"tau.q1": 0.0})
        one.step(0.1, 0.1)
        assert np.isfinite(one.get(["x.q1", "kinetic_energy"])).all()


@pytest.mark.parametrize("version", VERSIONS)
def test_null_pointers_and_foreign_tokens_are_refused(made, version):
    with made.instance(system_of("double_pendulum"), version) as one:
        calls = one.fmu
        if version == 3:
            assert calls.dll.fmi3GetFloat64(None, None, 0, None, 0) == 3
            refused = [
                lambda: calls.fmi3GetFloat64(calls.component, None, 1, None, 1),
                lambda: calls.fmi3GetFMUState(calls.component, None),
                lambda: calls.fmi3DeserializeFMUState(calls.component, None, 10, None),
            ]
        else:
            assert calls.dll.fmi2GetReal(None, None, 0, None) == 3
            refused = [
                lambda: calls.fmi2GetReal(calls.component, None, 1, None),
                lambda: calls.fmi2GetFMUstate(calls.component, None),
                lambda: calls.fmi2DeSerializeFMUstate(calls.component, None, 10, None),
            ]
        for call in refused:
            with pytest.raises(CALL_FAILED):
                call()
            assert one.log[-1][0] == 3
    path = made.fmu(system_of("double_pendulum"), version)
    with pytest.raises(Exception, match="Failed to instantiate"):
        Instance(path, MODEL_EXCHANGE, name="")


@pytest.mark.parametrize("version", VERSIONS)
def test_casadi_imports_rates_and_exact_jacobians(made, version, tmp_path):
    system = system_of("double_pendulum")
    library = made.library(system)
    inputs = Inputs(system, library)
    fmpy.extract(str(made.fmu(system, version)), tmp_path)
    importer = casadi.DaeBuilder("imported", str(tmp_path))
    rates = importer.create("rates", ["x", "u", "p"], ["ode"])
    values = ([*inputs.x, *inputs.y], inputs.further["tau"], [9.81, 2.0, 1.0, 0.5, 0.7])
    tuned = library.with_parameters({"m1": 2.0})
    found = rates(*values).full().ravel()[2:]
    assert np.array_equal(found, tuned.forward_dynamics(inputs.x, inputs.y, *values[1:2]))
    by_all = rates.factory("jacobian", ["x", "u", "p"], ["jac:ode:x", "jac:ode:u", "jac:ode:p"])
    found = np.hstack([one.full() for one in by_all(*values)])
    expected = tuned.forward_dynamics_derivatives(inputs.x, inputs.y, *values[1:2])
    assert np.allclose(found[2:], expected, rtol=1e-14, atol=0.0)


def test_what_cannot_become_an_fmu_is_refused_in_one_line(tmp_path):
    system = system_of("double_pendulum")
    with pytest.raises(OptionError, match=r"fmi3: the real numbers of FMI are doubles.*are float\. Take"):
        kg.generate(system, artifacts=["fmi3"], tier="single")
    with pytest.raises(OptionError, match=r"fmi2: .*lacks rollout_rk4.*Add --output rollout_rk4"):
        kg.generate(system, ("forward_dynamics",), artifacts=["fmi2"])
    with pytest.raises(OptionError, match="lacks forward_dynamics"):
        kg.export(kg.generate(system), "fmi3", tmp_path)
    held = kg.load(ROOT / "models" / "gantry_crane.toml").with_contacts({"load": ["s1"]})
    with pytest.raises(OptionError, match="has contacts"):
        kg.generate(held, artifacts=["fmi3"])


@pytest.mark.slow
def test_double_double_arithmetic_has_the_bits_of_the_library(made):
    system = system_of("double_pendulum")
    source = kg.generate(system, artifacts=["fmi3"], tier="exact")
    library = load(source)
    with Instance(kg.export(source, "fmi3", made.folder / "exact.fmu"), MODEL_EXCHANGE) as one:
        one.initialize({"x.q1": 0.5, "y.q2": -1.0, "parameters.m1": 2.0})
        expected = library.with_parameters({"m1": 2.0}).forward_dynamics([0.5, 0.0], [0.0, -1.0])
        assert np.array_equal(one.rates()[2:], expected)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("kind", KINDS)
def test_fmpy_simulates_the_motion_of_kanegen(made, version, kind):
    system = system_of("double_pendulum")
    result = fmpy.simulate_fmu(
        str(made.fmu(system, version)),
        fmi_type=kind,
        stop_time=2.0,
        start_values={"x.q1": 0.5, "y.q2": 1.0, "parameters.l2": 0.8},
        output=["x.q1", "x.q2", "y.q1", "y.q2"],
        output_interval=0.01,
        relative_tolerance=1e-10,
    )
    library = made.library(system).with_parameters({"l2": 0.8})
    exact = kg.simulate(library, {"q1": 0.5}, {"q2": 1.0}, [0.0, 2.0], method="DOP853", tolerance=1e-12)
    found = [result[name][-1] for name in ("x.q1", "x.q2", "y.q1", "y.q2")]
    expected = [*exact.x[-1], *exact.y[-1]]
    tolerance = 1e-6 if kind == MODEL_EXCHANGE else 1e-9  # CVode asked for 1e-10 a step; RK4 in steps of 1 ms
    assert np.allclose(found, expected, rtol=0.0, atol=tolerance)


def test_the_same_model_gives_the_same_bytes(made, tmp_path):
    system = system_of("double_pendulum")
    again = kg.export(system_of("double_pendulum"), "fmi3", tmp_path)
    assert again.name == "double_pendulum_fmi3.fmu"
    assert again.read_bytes() == made.fmu(system, 3).read_bytes()


@pytest.mark.parametrize("compiler", slow_except(("gcc", "clang"), "gcc"))
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", MODELS)
def test_sources_compile_without_warnings(made, name, version, compiler, tmp_path):
    fmpy.extract(str(made.fmu(system_of(name), version)), tmp_path)
    sources = tmp_path / "sources"
    named = [f"fmi{version}.c", f"{name}_fmu.c"]
    assert {path.name for path in sources.glob("*.c")} == {*named, f"{name}.c"}
    run(*C[compiler], "-std=c99", "-O1", "-fno-pie", *OWN_WARNINGS, "-c", *named, folder=sources)
    symbols = run("nm", *(f"{Path(file).stem}.o" for file in named), folder=sources)
    assert not re.findall(
        r"^[0-9a-f]* [bBdDC] .*", symbols, re.MULTILINE
    )  # no variable is shared by instances


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_fmpy_compiles_the_sources(made, version, tmp_path):
    system = system_of("double_pendulum")
    fmpy.extract(str(made.fmu(system, version)), tmp_path / "unit")
    shutil.rmtree(tmp_path / "unit" / "binaries")
    build = tmp_path / "build"
    build.mkdir()
    fmpy.build.build_platform_binary(tmp_path / "unit", build)
    result = fmpy.simulate_fmu(str(tmp_path / "unit"), start_values={"x.q1": 0.5}, stop_time=0.1)
    original = fmpy.simulate_fmu(str(made.fmu(system, version)), start_values={"x.q1": 0.5}, stop_time=0.1)
    assert np.array_equal(result["x.q1"], original["x.q1"])


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_sanitizers_find_nothing(made, version, tmp_path):
    """A program calls the functions of FMI as an importer does, also wrongly, under AddressSanitizer."""
    fmpy.extract(str(made.fmu(system_of("satellite"), version)), tmp_path)
    sources = tmp_path / "sources"
    (sources / "importer.c").write_text((HERE / f"fmi{version}_importer.c").read_text())
    named = [path.name for path in sources.glob("*.c")]
    run(*C["gcc"], "-std=c99", *SANITIZERS, *OWN_WARNINGS, *named, "-lm", "-o", "importer", folder=sources)
    printed = run(str(sources / "importer"), *arguments(tmp_path), folder=sources)
    assert printed.splitlines()[-1] == "done"


@pytest.mark.embed("fmu_manipulation_toolbox")
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", MODELS)
def test_the_checker_of_the_fmu_manipulation_toolbox_finds_nothing(made, name, version):
    tool = Path(sys.executable).parent / "fmutool"
    command = [str(tool), "-input", str(made.fmu(system_of(name), version)), "-check"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    said = done.stdout + done.stderr
    assert f"compliant with FMI-{version}.0" in said
    assert f"No semantic error against the FMI-{version} standard" in said


@pytest.mark.embed("libcosimpy")
@pytest.mark.parametrize("name", MODELS)
def test_libcosim_simulates_without_a_complaint(made, name, tmp_path):
    """The library of the Open Simulation Platform reads FMUs by FMI Library, as the checker of FMI does."""
    system = system_of(name)
    states = len(system.coordinates) + len(system.freedoms)
    script = tmp_path / "master.py"
    script.write_text(LIBCOSIM)
    command = [sys.executable, str(script), str(made.fmu(system, 2)), str(states)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    said = [
        line for line in (done.stdout + done.stderr).splitlines() if "[error]" in line or "[warning]" in line
    ]
    assert said == []
    found = next(line for line in done.stdout.splitlines() if not line.startswith("["))
    library = made.library(system)
    start = system.neutral_coordinates, np.zeros(len(system.freedoms))
    zeros = {n: np.zeros_like(v) for n, v in Inputs(system, library).further.items() if n != "t"}
    rollout = library.rollout(*start, steps=1000, step=1e-3, **zeros)
    expected = [*rollout.x[-1], *rollout.y[-1]]
    assert np.allclose([float(word) for word in found.split()], expected, rtol=1e-9, atol=1e-9)


LIBCOSIM = """
import sys

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

execution = CosimExecution.from_step_size(step_size=1e7)  # ns
slave = execution.add_local_slave(CosimLocalSlave(fmu_path=sys.argv[1], instance_name="one"))
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
assert execution.simulate_until(target_time=1e9)
print(*observer.last_real_values(slave_index=slave, variable_references=range(1, 1 + int(sys.argv[2]))))
"""


@pytest.mark.embed("wine")
@pytest.mark.parametrize("version", VERSIONS)
def test_a_library_for_windows_runs(made, version, tmp_path):
    system = system_of("double_pendulum")
    platforms = ["x86_64-windows", "aarch64-linux", "x86_64-linux"]
    path = kg.export(made.source(system), f"fmi{version}", tmp_path / "all.fmu", platforms=platforms)
    fmpy.extract(str(path), tmp_path / "unit")
    binaries = tmp_path / "unit" / "binaries"
    folders = {2: {"win64", "aarch64-linux", "linux64"}, 3: set(platforms)}[version]
    assert {one.name for one in binaries.iterdir()} == folders
    library = next(binaries.glob("*win*/*.dll"))
    sources = tmp_path / "unit" / "sources"
    (sources / "importer.c").write_text((HERE / f"fmi{version}_importer.c").read_text())
    zig = [
        sys.executable,
        "-m",
        "ziglang",
        "cc",
        "-target",
        "x86_64-windows-gnu",
        "-std=c99",
        "-O1",
        f"-DFMI{version}_Export=",
    ]
    program = tmp_path / "importer.exe"
    run(*zig, "importer.c", str(library), "-o", str(program), folder=sources)
    shutil.copy(library, tmp_path)
    printed = run("wine", str(program), *arguments(tmp_path / "unit"), folder=tmp_path)
    assert printed.splitlines()[-1].strip() == "done"


def arguments(folder):
    """Arguments of the importers in C: the token, and the number of states."""
    description = fmpy.read_model_description(str(folder))
    return description.guid, str(len(description.derivatives))


@pytest.mark.slow
def test_the_page(tmp_path, monkeypatch):
    folder = copy_of_checkout(tmp_path / "checkout")
    monkeypatch.chdir(folder)
    namespace = {}
    for block in fenced("embedding/fmi"):
        if block.language == "python" and not block.before.startswith("<!-- long"):
            exec(block.text, namespace)
        if block.language == "console":
            run_console(block.text, folder)
    assert namespace["result"]["time"][-1] == 1.0
    values = ([0.1, 0.2, 0.3, 0.4], [0.0, 0.0], [9.81, 1.0, 1.0, 0.5, 0.7])
    assert namespace["jacobian"](*values)[0].shape == (4, 4)
    written = {path.name for path in (folder / "build" / "fmi").iterdir()}
    assert {"double_pendulum_fmi2.fmu", "double_pendulum_fmi3.fmu", "fmi2", "fmi3"} <= written
    for version in VERSIONS:
        path = folder / "build" / "fmi" / f"double_pendulum_fmi{version}.fmu"
        assert validate_fmu(str(path)) == []


def test_a_motion_takes_at_most_five_lines():
    first = next(block for block in fenced("embedding/fmi") if block.language == "python")
    assert len([line for line in first.text.splitlines() if line]) <= 5
