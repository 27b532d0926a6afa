"""Mex files under Octave: bits of the C, batches, parameters, statuses, wrong arguments, and ode solvers."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat, savemat

import kanegen as kg
from kanegen.errors import OptionError
from kanegen.program.ir import PREPARED
from kanegen.recursion.outputs import available
from kanegen.reference.equations import forcing, mass_matrix
from kanegen.reference.states import random_states
from tests.support.c_compilers import WARNINGS
from tests.support.octave import octave
from tests.support.pages import blocks, run
from tests.support.paths import MODELS, PENDULUM
from tests.support.random_trees import everything

DYNAMICS = "mass_matrix", "forcing", "forward_dynamics"

CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "pendulum": ("double_pendulum", {"outputs": "every"}),
    "single": ("double_pendulum", {"outputs": DYNAMICS, "precision": "float"}),
    "arm": ("panda_arm", {"outputs": ("forward_dynamics", "forward_dynamics_derivatives")}),
    "satellite": ("satellite", {"outputs": (*DYNAMICS, "coordinate_rates", "step_rk4")}),
    "body": ("free_body", {"outputs": DYNAMICS}),
    "everything": ("", {"outputs": (*DYNAMICS, "contact_dynamics", "point_positions", "coordinate_rates")}),
    "by_state": ("double_pendulum", {"outputs": DYNAMICS, "parameters_by_state": True}),
}
"""Model and choices of every mex file: parameters, loads, quaternions, single precision."""

LOADS = ("force", "torque", "point_force", "point_moment", "t", "prescribed")
"""Inputs from outside, of which only some systems have each."""

STATES = 4


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[kg.Source, Path]]:
    """Every source with its folder, in which Octave has built the mex file."""
    found = {}
    for name, (model, choices) in CASES.items():
        system = (
            kg.load(MODELS / f"{model}.toml")
            if model
            else everything(3, bodies=2).with_prescribed("b1.theta2")
        )
        outputs = available(system) if choices["outputs"] == "every" else choices["outputs"]
        source = kg.generate(system, artifacts="octave", **{**choices, "outputs": outputs})
        folder = source.write(tmp_path_factory.mktemp(name) / "mex")
        octave(f"{source.model.name}.build();", folder)
        found[name] = source, folder
    return found


def inputs_of(source: kg.Source) -> dict[str, np.ndarray]:
    """Return values of all inputs in some states, those of a state in a row, that the precision can hold."""
    assert source.system is not None
    states = random_states(source.system, STATES, seed=5)
    rng = np.random.default_rng(1)
    named = {"x": states.x, "y": states.y, "force": states.force, "torque": states.torque, **states.inputs}
    values = {name: array for name, array in named.items() if array is not None}
    values["step"] = np.full(STATES, 0.01)
    for function in source.functions:
        for array in function.inputs:
            if array.name not in (*values, PREPARED, "parameters"):
                values[array.name] = rng.uniform(-1, 1, (STATES, *array.shape))
    kind = np.float32 if source.precision == "float" else np.float64
    return {name: value.astype(kind).astype(float) for name, value in values.items()}


def states_last(value: np.ndarray) -> np.ndarray:
    """Return an array as MATLAB has it: the states along the last axis, a row for numbers."""
    return value[None] if value.ndim == 1 else np.moveaxis(value, 0, -1)


def states_first(value: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Return an array of MATLAB as NumPy has it; MATLAB drops a last axis of length 1."""
    if not shape:
        return value.reshape(-1)
    return np.moveaxis(value.reshape(*shape, -1, order="F"), -1, 0)


@pytest.mark.embed("octave", "mkoctfile")
@pytest.mark.parametrize("case", CASES)
def test_results_have_the_bits_of_the_c_and_are_those_of_the_reference(
    case: str, built: dict[str, tuple[kg.Source, Path]], tmp_path: Path
) -> None:
    source, folder = built[case]
    values, model = inputs_of(source), source.model.name
    savemat(tmp_path / "in.mat", {name: states_last(value) for name, value in values.items()})
    lines = [f"load('{tmp_path}/in.mat'); found = struct();"]
    called = [one for one in source.functions if one.name != "prepare"]
    for place, function in enumerate(called):
        given = [array for array in function.inputs if array.name != PREPARED]
        many = ", ".join(array.name for array in given)
        one = ", ".join(f"{a.name}({':, ' * max(1, len(a.shape))}2)" for a in given)
        for label, arguments in (("many", many), ("one", one)):
            results = [f"found.{label}{place}_{i}" for i, _ in enumerate(function.outputs)]
            lines.append(f"[{', '.join(results)}, status] = {model}.{function.name}({arguments});")
            lines.append("assert(all(status == 0)); assert(isa(status, 'int32'));")
            lines.append(f"[{', '.join(results)}] = {model}.{function.name}({arguments});")
    lines.append(f"save('-v6', '{tmp_path}/out.mat', '-struct', 'found');")
    octave("\n".join(lines), folder)
    out = loadmat(tmp_path / "out.mat")
    library = kg.library.load(source, on_status="raise")
    results_of = {}
    for place, function in enumerate(called):
        for i, array in enumerate(function.outputs):
            found = states_first(out[f"many{place}_{i}"], array.shape)
            single = states_first(out[f"one{place}_{i}"], array.shape)
            results_of[function.name] = found
            assert found.dtype == (np.float32 if source.precision == "float" else np.float64)
            assert np.array_equal(found[1:2], single), (function.name, array.name)
            if len(function.outputs) == 1:
                given = {a.name: values[a.name] for a in function.inputs if a.name != PREPARED}
                expected = getattr(library, function.name)(**given)
                assert np.array_equal(found, expected), function.name
    if "mass_matrix" in source.outputs:
        loads = {name: values[name] for name in LOADS if name in values}
        of_reference = {
            "mass_matrix": mass_matrix(source.system, values["x"], values.get("prescribed")),
            "forcing": forcing(source.system, values["x"], values["y"], **loads),
        }
        for name, expected in of_reference.items():
            # Sums of a few dozen terms: some hundred roundings of the largest entry.
            tolerance = 1e-4 if source.precision == "float" else 1e-12
            assert np.abs(results_of[name] - expected).max() <= tolerance * np.abs(expected).max(), name


WRONG = {
    "double_pendulum_mex()": "function: the first argument is the name of a function: mass_matrix",
    "double_pendulum_mex('mass')": "function: the first argument is the name",
    "double_pendulum_mex(3)": "function: the first argument is the name",
    "double_pendulum.forcing()": "arguments: forcing needs x.",
    "double_pendulum.forcing(x)": "arguments: forcing needs y.",
    "double_pendulum.forcing([], y)": "size: x has size 0 x 0, not 2 x the number of states.",
    "double_pendulum.forcing(x, y, p, 1, 2)": "arguments: forcing takes 2 arguments and parameters",
    "[a, b, c] = double_pendulum.forcing(x, y)": "arguments: forcing takes 2 arguments and parameters",
    "double_pendulum.forcing(int32(x), y)": "type: x is int32; give a full real array of class double",
    "double_pendulum.forcing(x, y + 1i)": "type: y is complex double; give",
    "double_pendulum.forcing(sparse(x), y)": "type: x is sparse double; give",
    "double_pendulum.forcing('ab', y)": "type: x is char; give",
    "double_pendulum.forcing({1, 2}, y)": "type: x is cell; give",
    "double_pendulum.forcing(true(2, 1), y)": "type: x is logical; give",
    "double_pendulum.forcing(struct(), y)": "type: x is struct; give",
    "double_pendulum.forcing(@sin, y)": "type: x is function_handle; give",
    "double_pendulum.forcing([x; 1], y)": "size: x has size 3 x 1, not 2 x the number of states.",
    "double_pendulum.forcing(zeros(0, 2), y)": "size: x has size 0 x 2, not 2 x the number of states.",
    "double_pendulum.forcing(zeros(2, 2, 2), y)": "size: x has size 2 x 2 x 2, not 2 x the number of states.",
    "double_pendulum.forcing(zeros(2, 3), zeros(2, 4))": "size: y is for 4 states, x for 3.",
    "double_pendulum.forcing(x, y, [1 2])": "size: parameters has 2 elements, not 5; double_pendulum.p",
    "double_pendulum.forcing(x, y, struct('m3', 1))": "parameters: parameters has a field m3, but the model",
    "double_pendulum.forcing(x, y, struct('m1', [1 2]))": "parameters: parameters.m1 is not one number.",
    "double_pendulum.forcing(x, y, struct('m1', 'a'))": "type: parameters.m1 is char; give",
    "double_pendulum.forcing(x, y, struct('m1', {1, 2}))": "parameters: parameters is an array of structs",
    "double_pendulum.forcing(x, y, struct('g', Inf))": "parameters: with these parameters, a constant is",
    "double_pendulum.forward_dynamics(x, y, [], struct('l1', 0))": "missing: forward_dynamics: the pivot of "
    "[A] at freedom q1 of body upper is not positive or is NaN: [A] is singular, or an input is infinite "
    "or NaN.",
}
"""Calls, and the beginning of identifier and message of their errors."""


@pytest.mark.embed("octave", "mkoctfile")
def test_wrong_arguments_end_in_one_line(built: dict[str, tuple[kg.Source, Path]]) -> None:
    _, folder = built["pendulum"]
    lines = ["x = [0.1; 0.2]; y = [0.3; 0.4]; p = double_pendulum.parameters();"]
    for call in WRONG:
        lines.append(f"try\n  {call};\n  disp('no error');\ncatch e")
        lines.append("  disp([e.identifier ': ' strrep(e.message, 'double_pendulum_mex: ', '')]);\nend")
    printed = octave("\n".join(lines), folder).splitlines()
    for (call, message), line in zip(WRONG.items(), printed, strict=False):
        assert line.startswith(f"kanegen:double_pendulum:{message}"), (call, line)


@pytest.mark.embed("octave", "mkoctfile")
def test_loads_that_the_model_does_not_take_are_errors(built: dict[str, tuple[kg.Source, Path]]) -> None:
    """Row 1 is that of the bus, which takes loads; the panels take none."""
    _, folder = built["satellite"]
    printed = octave(
        """
        x = [1; zeros(8, 1)]; y = zeros(8, 1); load = zeros(3); load(2, 1) = 1;
        a = satellite.forward_dynamics(x, y, [], [1 2 3; 0 0 0; 0 0 0]);
        assert(all(isfinite(a)) && any(a != 0));
        try
          satellite.forward_dynamics(x, y, [], load); disp('no error');
        catch e
          disp([e.identifier ': ' strrep(e.message, 'satellite_mex: ', '')]);
        end
        try
          satellite.forward_dynamics([x x], y, [], [], cat(3, zeros(3), NaN*load)); disp('no error');
        catch e
          disp(strrep(e.message, 'satellite_mex: ', ''));
        end
        """,
        folder,
    )
    message = (
        "row 2 is not zero, but body 'left_panel' takes no loads. Enter it among the loads of the model."
    )
    assert printed.splitlines()[:2] == [f"kanegen:satellite:loads: force: {message}", f"torque: {message}"]


@pytest.mark.embed("octave", "mkoctfile")
def test_statuses_parameters_and_sizes(built: dict[str, tuple[kg.Source, Path]]) -> None:
    _, folder = built["pendulum"]
    octave(
        """
        x = [0.1; 0.2]; y = [0.3; 0.4];
        f = double_pendulum.forcing(x, y);
        assert(isequal(double_pendulum.forcing(x', y'), f));
        assert(isequal(double_pendulum.forcing(x, y, double_pendulum.parameters()), f));
        assert(isequal(double_pendulum.forcing(x, y, struct('m1', 1)), f));
        assert(isequal(double_pendulum.forcing(x, y, [9.81 1 1 0.5 0.7]), f));
        assert(isequal(double_pendulum.forcing(x, y, []), f));
        assert(! isequal(double_pendulum.forcing(x, y, struct('m1', 2)), f));
        assert(isequal(double_pendulum.forcing(single(x), y), double_pendulum.forcing(double(single(x)), y)));
        assert(isequal(double_pendulum.forcing([x x x], y), [f f f]));
        assert(isequal(size(double_pendulum.forcing(zeros(2, 0), zeros(2, 0))), [2 0]));
        assert(isequal(size(double_pendulum.mass_matrix(zeros(2, 5))), [2 2 5]));
        a = double_pendulum.forward_dynamics(x, y, [0; 0]);
        assert(isequal(double_pendulum.forward_dynamics(x, y), a));
        n = double_pendulum.names();
        assert(isequal(n.freedoms, {'q1'; 'q2'}) && isequal(n.parameters{1}, 'g'));
        assert(isequal(n.speed_units, {'rad/s'; 'rad/s'}));

        lastwarn('', '');
        f = double_pendulum.forcing([NaN; 0], y);
        [text, id] = lastwarn();
        assert(isnan(f(1)) && strcmp(id, 'kanegen:double_pendulum:notFinite'));
        assert(strcmp(strrep(text, 'double_pendulum_mex: ', ''), 'forcing: a result is infinite or NaN.'));
        f = double_pendulum.forcing([x [NaN; 0] x], y);
        [text, id] = lastwarn();
        assert(strcmp(id, 'kanegen:double_pendulum:states'));
        assert(strncmp(strrep(text, 'double_pendulum_mex: ', ''), 'forcing: 1 of 3 states', 22));
        lastwarn('', '');
        [f, status] = double_pendulum.forcing([x [NaN; 0] x], y);
        assert(isequal(status, int32([0 3 0])) && isempty(lastwarn()));
        [a, status] = double_pendulum.forward_dynamics(x, y, [], struct('l1', 0));
        assert(status == 1 && isempty(lastwarn()) && all(isnan(a)));
        """,
        folder,
    )


@pytest.mark.embed("octave", "mkoctfile")
def test_parameters_by_state(built: dict[str, tuple[kg.Source, Path]]) -> None:
    _, folder = built["by_state"]
    octave(
        """
        x = [0.1; 0.2]; y = [0.3; 0.4]; p = [9.81 1 1 0.5 0.7]'; q = [9.81 2 1 0.5 0.7]';
        f = double_pendulum.forcing(x, y, p); g = double_pendulum.forcing(x, y, struct('m1', 2));
        assert(! isequal(f, g));
        assert(isequal(double_pendulum.forcing([x x x], y, [p q p]), [f g f]));
        assert(isequal(double_pendulum.forcing([x x x], y, q), [g g g]));
        [f2, status] = double_pendulum.forcing([x x x], y, [p q p]);
        assert(isequal(f2, [f g f]));
        try
          double_pendulum.forcing([x x x], y, [p q]); assert(false);
        catch e
          assert(strcmp(e.identifier, 'kanegen:double_pendulum:size'));
        end
        """,
        folder,
    )


@pytest.mark.embed("octave", "mkoctfile")
def test_help_names_arrays_and_units(built: dict[str, tuple[kg.Source, Path]]) -> None:
    _, folder = built["arm"]
    text = octave("help panda_arm.forward_dynamics", folder)
    assert "[acceleration, status] = panda_arm.forward_dynamics(x, y, tau)" in text
    assert "7 x B" in text and "(rad/s, m/s)" in text


def test_the_mex_file_compiles_without_warnings(tmp_path: Path) -> None:
    """Octave's header is not needed: only what the file calls is declared."""
    (tmp_path / "mex.h").write_text(MEX)
    for case in ("single", "body", "by_state", "satellite"):
        model, choices = CASES[case]
        source = kg.generate(kg.load(MODELS / f"{model}.toml"), artifacts="octave", **choices)
        for name, text in source.files.items():
            if name.endswith((".c", ".h")):
                (tmp_path / name).write_text(text)
        for compiler in ("gcc", "clang"):
            command = [compiler, "-std=c99", *WARNINGS, "-Werror", "-fsyntax-only", f"{model}_mex.c"]
            done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr


MEX = """
#include <stddef.h>
typedef struct mxArray mxArray;
typedef int mwSize;
typedef enum { mxDOUBLE_CLASS, mxSINGLE_CLASS, mxINT32_CLASS } mxClassID;
typedef enum { mxREAL } mxComplexity;
int mxIsSparse(const mxArray *), mxIsComplex(const mxArray *), mxIsDouble(const mxArray *);
int mxIsSingle(const mxArray *), mxIsStruct(const mxArray *), mxIsChar(const mxArray *);
int mxGetString(const mxArray *, char *, mwSize), mxGetNumberOfFields(const mxArray *);
const char *mxGetClassName(const mxArray *), *mxGetFieldNameByNumber(const mxArray *, int);
mxArray *mxGetFieldByNumber(const mxArray *, mwSize, int);
const mwSize *mxGetDimensions(const mxArray *);
mwSize mxGetNumberOfDimensions(const mxArray *);
size_t mxGetNumberOfElements(const mxArray *), mxGetM(const mxArray *), mxGetN(const mxArray *);
void *mxGetData(const mxArray *), *mxCalloc(size_t, size_t), mxFree(void *);
mxClassID mxGetClassID(const mxArray *);
mxArray *mxCreateNumericArray(mwSize, const mwSize *, mxClassID, mxComplexity);
void mexFunction(int, mxArray *[], int, const mxArray *[]);
void mexErrMsgIdAndTxt(const char *, const char *, ...), mexWarnMsgIdAndTxt(const char *, const char *, ...);
"""
"""What the file needs of mex.h."""


def test_what_matlab_cannot_hold_is_refused() -> None:
    system = kg.load(PENDULUM)
    with pytest.raises(OptionError, match="octave: MATLAB and Octave have no numbers in long double"):
        kg.generate(system, precision="long double", artifacts="octave")
    with pytest.raises(OptionError, match="octave: names in MATLAB have at most 63 characters"):
        kg.generate(system.with_name("a" * 60), artifacts="octave")


def test_a_package_has_no_reserved_name() -> None:
    files = kg.generate(kg.load(PENDULUM).with_name("end"), artifacts="octave").files
    assert "+end_/build.m" in files and "end_mex.c" in files


@pytest.mark.embed("octave", "mkoctfile")
def test_the_page(tmp_path: Path) -> None:
    (tmp_path / "models").symlink_to(MODELS)
    for command in blocks("embedding/octave", "sh"):
        run(command.strip(), tmp_path)
    printed = octave("\n".join(blocks("embedding/octave", "octave")), tmp_path / "build" / "octave")
    last = kg.simulate(
        kg.build(kg.load(PENDULUM), ("forward_dynamics",)), [0.5, 0.3], [0, 0], [0.0, 1.0], step=1e-3
    )
    assert f"{last.x[-1, 0]:.4f} {last.x[-1, 0]:.4f} {last.x[-1, 0]:.4f}" in printed.splitlines()
    assert "q1 (rad/s)" in printed and "[acceleration, status]" in printed
    assert "  0  3" in printed.splitlines()
