"""FMUs for FMI 2.0 and 3.0 in FMPy and CasADi: valid, the numbers of the library, and what attacks them."""

import itertools

import numpy as np
import pytest
from fmpy.validation import validate_fmu

import kanegen as kg
from kanegen.artifacts.fmi.names import dotted
from kanegen.library import load
from kanegen.model.arguments import LOADS
from kanegen.reference.states import random_states
from tests.support.fmu import CO_SIMULATION, MODEL_EXCHANGE, Instance
from tests.support.paths import ROOT

VERSIONS = (2, 3)
KINDS = (MODEL_EXCHANGE, CO_SIMULATION)

SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("panda_arm", "gantry_crane", "quarter_car")]
MODELS = ["double_pendulum", "satellite", *SLOW]


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
    held = {n: v for n, v in inputs.further.items() if n not in ("prescribed",)}
    with initialized(made, system, version, inputs, CO_SIMULATION) as one:
        start = float(inputs.further.get("t", 0.0))
        for number in range(5):
            one.step(start + 0.01 * number, 0.01)
        names = [name for name in one.variables if name.startswith(("x.", "y."))]
        if "prescribed" in inputs.further:
            return
        rollout = library.rollout(inputs.x, inputs.y, steps=50, step=1e-3, **held)
        assert np.allclose(
            one.get(names), np.concatenate([rollout.x[-1], rollout.y[-1]]), rtol=1e-13, atol=1e-13
        )
