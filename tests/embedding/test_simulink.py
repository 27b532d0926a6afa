"""Functions for the block C Caller: prototypes of fixed sizes, no warnings, and the bits of the C."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cffi import FFI
from pycparser import CParser, c_ast

import kanegen as kg
from kanegen.c.interface import Function
from kanegen.errors import OptionError
from kanegen.program.ir import PREPARED, Array
from kanegen.recursion.outputs import available
from kanegen.reference.states import random_states
from tests.support.c_compilers import WARNINGS
from tests.support.pages import blocks, run
from tests.support.paths import MODELS, PENDULUM

DYNAMICS = "mass_matrix", "forcing", "forward_dynamics"

CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "pendulum": ("double_pendulum", {"outputs": (*DYNAMICS, "kinetic_energy", "body_poses")}),
    "single": ("double_pendulum", {"outputs": DYNAMICS, "precision": "float"}),
    "arm": ("panda_arm", {"outputs": ("forward_dynamics", "forward_dynamics_derivatives")}),
    "satellite": ("satellite", {"outputs": ("coordinate_rates", "step_rk4")}),
    "body": ("free_body", {"outputs": DYNAMICS}),
}
"""Model and choices: parameters, three axes, single precision, quaternions and steps, loads with two axes."""


def source_of(case: str) -> kg.Source:
    model, choices = CASES[case]
    return kg.generate(kg.load(MODELS / f"{model}.toml"), artifacts="simulink", **choices)


def functions(source: kg.Source) -> list[Function]:
    return [one for one in source.functions if one.name != "prepare"]


def arrays(function: Function, source: kg.Source) -> list[Array]:
    """Return all arguments of the function of a block, in their order."""
    inputs = [array for array in function.inputs if array.name != PREPARED]
    if len(inputs) < len(function.inputs):
        inputs += next(one for one in source.functions if one.name == "prepare").inputs
    return [*inputs, *function.outputs]


SLOW = {"arm"}
"""Cases whose code takes several seconds to generate."""


def cases(*names: str) -> list[Any]:
    return [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in names]


@pytest.mark.parametrize("case", cases(*CASES))
def test_c_caller_can_read_every_prototype(case: str) -> None:
    """The header holds prototypes alone; every array has a number as its size, every number is a value."""
    source = source_of(case)
    header = source.files[f"{source.model.name}_simulink.h"]
    text = re.sub(r"/\*.*?\*/", "", header, flags=re.S)
    assert not re.findall(r"#\s*(?:include|define \S+ \S)|struct|typedef|enum", text)
    text = re.sub(r"^#ifdef __cplusplus$.*?^#endif$", "", text, flags=re.M | re.S)
    text = re.sub(r"^#.*$", "", text, flags=re.M)
    declarations = CParser().parse(text).ext
    kind = "float" if source.precision == "float" else "double"
    assert len(declarations) == len(functions(source))
    for declaration, function in zip(declarations, functions(source), strict=True):
        assert declaration.name == f"{source.model.name}_block_{function.name}"
        expected = arrays(function, source)
        assert [one.name for one in declaration.type.args.params] == [array.name for array in expected]
        for parameter, array in zip(declaration.type.args.params, expected, strict=True):
            is_value = not array.shape and array not in function.outputs
            if is_value:
                (name,) = parameter.type.type.names
            else:
                assert isinstance(parameter.type, c_ast.ArrayDecl)
                assert parameter.type.dim.value == str(array.size)
                (name,) = parameter.type.type.type.names
                assert ("const" in parameter.quals) == (array not in function.outputs)
            assert name == kind


@pytest.fixture(scope="module", params=cases("pendulum", "arm", "satellite", "body"))
def compiled(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A source and its functions for blocks, compiled without warnings."""
    source = source_of(request.param)
    folder, name = source.write(tmp_path_factory.mktemp(request.param) / "c"), source.model.name
    files = [f"{name}_simulink.c", f"{name}.c"]
    command = ["-std=c99", "-ffp-contract=off", *WARNINGS, "-Werror"]
    subprocess.run(["clang", *command, "-fsyntax-only", files[0]], cwd=folder, check=True)
    shared = ["-O0", "-fPIC", "-shared", "-o", "blocks.so"]
    subprocess.run(["gcc", *command, *shared, *files, "-lm"], cwd=folder, check=True)
    text = source.files[f"{name}_simulink.h"]
    ffi = FFI()
    for prototype in re.findall(r"^int [^;]*;", text, flags=re.M):
        ffi.cdef(prototype)
    return source, ffi, ffi.dlopen(str(folder / "blocks.so"))


def test_results_have_the_bits_of_the_c(compiled: Any) -> None:
    source, ffi, blocks = compiled
    library = kg.library.load(source, on_status="raise")
    states = random_states(source.system, 3, seed=2)
    named = {"x": states.x, "y": states.y, "force": states.force, "torque": states.torque, **states.inputs}
    rng = np.random.default_rng(3)
    for state in range(3):
        values = {name: array[state] for name, array in named.items() if array is not None}
        values["parameters"] = np.array([value for _, value in source.model.parameters])
        values["step"] = np.array(0.01)
        for function in functions(source):
            if len(function.outputs) > 1:
                continue
            for array in arrays(function, source):
                values.setdefault(array.name, rng.uniform(-1, 1, array.shape))
            arguments: list[Any] = []
            for array in arrays(function, source):
                if not array.shape and array not in function.outputs:
                    arguments.append(float(values[array.name]))
                else:
                    arguments.append(ffi.new("double[]", values[array.name].ravel(order="F").tolist()))
            status = getattr(blocks, f"{source.model.name}_block_{function.name}")(*arguments)
            assert status == 0
            (output,) = function.outputs
            found = np.array(list(arguments[-1])).reshape(output.shape, order="F")
            given = {array.name: values[array.name] for array in function.inputs if array.name != PREPARED}
            expected = getattr(library, function.name)(**given)
            assert np.array_equal(found, expected), function.name


@pytest.mark.parametrize("compiled", ["pendulum"], indirect=True)
def test_a_status_of_the_parameters_is_returned(compiled: Any) -> None:
    source, ffi, blocks = compiled
    infinite = ffi.new("double[5]", [9.81, 1.0, float("inf"), 0.5, 0.7])
    status = blocks.double_pendulum_block_mass_matrix([0.1, 0.2], infinite, ffi.new("double[4]"))
    assert status == len(source.model.freedom_names) + 1


def test_the_page_names_files_and_shapes() -> None:
    page = source_of("body").files["free_body_simulink.md"]
    assert "`free_body_simulink.c`, `free_body.c`" in page
    assert "| `free_body_block_mass_matrix` | `A` | 6 x 6 |" in page


@pytest.mark.slow
def test_every_output_compiles(tmp_path: Path) -> None:
    system = kg.load(PENDULUM)
    source = kg.generate(system, available(system), artifacts="simulink")
    folder = source.write(tmp_path / "c")
    command = ["gcc", "-std=c99", *WARNINGS, "-Werror", "-fsyntax-only", "double_pendulum_simulink.c"]
    subprocess.run(command, cwd=folder, check=True)


def test_other_precisions_are_refused() -> None:
    with pytest.raises(OptionError, match="simulink: Simulink has no signals in long double"):
        kg.generate(kg.load(PENDULUM), precision="long double", artifacts="simulink")


def test_the_page(tmp_path: Path) -> None:
    (tmp_path / "models").symlink_to(MODELS)
    (command,) = blocks("embedding/simulink", "sh")
    run(command.strip(), tmp_path)
    (prototype,) = blocks("embedding/simulink", "c")
    assert prototype in (tmp_path / "build" / "simulink" / "double_pendulum_simulink.h").read_text()
