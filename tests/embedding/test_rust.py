"""Crates of Rust: their numbers beside C and reference, statuses, names, and their own tests."""

from __future__ import annotations

import ast
import os
import re
import subprocess
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.artifacts.rust.names import CRATES, crate_name, doc
from kanegen.errors import OptionError
from kanegen.model.identifiers import RESERVED
from kanegen.program.ir import PREPARED
from kanegen.recursion.outputs import available
from kanegen.reference.equations import forcing, mass_matrix
from kanegen.reference.states import random_states
from tests.support.pages import blocks, files, run
from tests.support.paths import MODELS, PENDULUM
from tests.support.random_trees import everything

ARM = "forward_dynamics", "forward_dynamics_derivatives"
DYNAMICS = "mass_matrix", "forcing", "forward_dynamics"

CRATES_OF_MODELS: dict[str, tuple[str, dict[str, Any]]] = {
    "double_pendulum": ("double_pendulum", {"outputs": (*DYNAMICS, ARM[1], "kinetic_energy", "rollout_rk4")}),
    "double_pendulum_f32": ("double_pendulum", {"outputs": DYNAMICS, "precision": "float"}),
    "panda_arm": ("panda_arm", {"outputs": ARM}),
    "satellite": ("satellite", {"outputs": (*DYNAMICS, "coordinate_rates", "step_rk4")}),
    "free_body": ("free_body", {"outputs": DYNAMICS}),
    "everything": ("", {"outputs": (*DYNAMICS, "contact_dynamics", "point_positions", "coordinate_rates")}),
}
"""Model and choices of every crate of the test program: parameters, loads, quaternions, two precisions.

The last one is a random tree with points, contacts, prescribed motion, couplings, time and force elements.
"""

STATES = 3
"""Random states of every crate."""


def cargo(*arguments: str, folder: Path, target: Path, **environment: str) -> str:
    """Run Cargo and return what it prints."""
    done = subprocess.run(
        ["cargo", *arguments],
        cwd=folder,
        env={**os.environ, "CARGO_TARGET_DIR": str(target), "CARGO_TERM_COLOR": "never", **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"cargo {' '.join(arguments)}\n{done.stdout}"
    return done.stdout


def source_of(crate: str) -> kg.Source:
    model, choices = CRATES_OF_MODELS[crate]
    system = (
        kg.load(MODELS / f"{model}.toml") if model else everything(3, bodies=2).with_prescribed("b1.theta2")
    )
    return kg.generate(system, artifacts="rust", **choices)


@pytest.fixture(scope="module")
def target(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of what Cargo builds, one for all tests, so that `cc` is built once."""
    return tmp_path_factory.mktemp("target")


@pytest.fixture(scope="module")
def sources() -> dict[str, kg.Source]:
    return {crate: source_of(crate) for crate in CRATES_OF_MODELS}


@pytest.fixture(scope="module")
def crates(sources: dict[str, kg.Source], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with every crate in a folder of its name."""
    folder = tmp_path_factory.mktemp("crates")
    for crate, source in sources.items():
        source.write(folder / crate)
    return folder


def program(folder: Path, crates: Path, names: list[str], code: str) -> Path:
    """Write a program that uses some crates."""
    (folder / "src").mkdir(parents=True)
    needs = "".join(f'{name} = {{ path = "{crates / name / "rust"}" }}\n' for name in names)
    package = f'[package]\nname = "program"\nversion = "0.1.0"\nedition = "2021"\n\n[dependencies]\n{needs}'
    (folder / "Cargo.toml").write_text(package)
    (folder / "src" / "main.rs").write_text(code)
    return folder


def literal(values: np.ndarray, kind: str) -> str:
    """Return an array as an expression of Rust whose numbers are exactly these."""
    text = np.array2string(
        values,
        separator=", ",
        threshold=values.size + 1,
        formatter={"float_kind": lambda one: f"{float(one)!r}{kind}"},
    )
    return re.sub(r"\s+", " ", text)


def inputs_of(source: kg.Source, state: int) -> dict[str, np.ndarray]:
    """Return the values of all inputs of the functions in one random state, that the precision can hold."""
    assert source.system is not None
    states = random_states(source.system, STATES, seed=11)
    rng = np.random.default_rng(state)
    values: dict[str, np.ndarray] = {"step": np.array(0.01)}
    named = {"x": states.x, "y": states.y, "force": states.force, "torque": states.torque, **states.inputs}
    values |= {name: array[state] for name, array in named.items() if array is not None}
    for function in source.functions:
        for array in function.inputs:
            if array.name not in (*values, PREPARED, "parameters"):
                values[array.name] = rng.uniform(-1, 1, array.shape)
    kind = np.float32 if source.precision == "float" else np.float64
    return {name: value.astype(kind).astype(float) for name, value in values.items()}


def calls(crate: str, source: kg.Source) -> Iterator[str]:
    """Yield statements that print the results of every function in every state."""
    kind = "f32" if source.precision == "float" else "f64"
    new = "new(&Parameters::default()).unwrap()" if source.model.parameters else "new()"
    yield f"{{ use {crate}::*; let model = Model::{new};"
    for state in range(STATES):
        values = inputs_of(source, state)
        for function in source.functions:
            if function.name in ("prepare", "evaluate"):
                continue
            given = [
                f"{'&' * bool(array.shape)}{literal(values[array.name], kind)}"
                for array in function.inputs
                if array.name != PREPARED
            ]
            found = f"model.{function.name}({', '.join(given)}).unwrap()"
            if len(function.outputs) > 1:
                found = ", ".join(f"{found}.{one.name}" for one in function.outputs)
            marks = ", ".join(["{:?}"] * len(function.outputs))
            yield f'println!("{crate} {state} {function.name} ({marks},)", {found});'
    yield "}"


@pytest.fixture(scope="module")
def printed(
    crates: Path, sources: dict[str, kg.Source], tmp_path_factory: pytest.TempPathFactory, target: Path
) -> dict[tuple[str, int, str], tuple[np.ndarray, ...]]:
    """The results of every function in every state, as one program with all crates computes them."""
    lines = [line for crate, source in sources.items() for line in calls(crate, source)]
    code = "fn main() {\n" + "\n".join(lines) + "\n}\n"
    folder = program(tmp_path_factory.mktemp("all") / "program", crates, list(sources), code)
    found = {}
    for line in cargo("run", "--quiet", folder=folder, target=target).splitlines():
        crate, state, name, results = line.split(" ", 3)
        found[crate, int(state), name] = tuple(np.array(one) for one in ast.literal_eval(results))
    return found


@pytest.mark.embed("cargo")
@pytest.mark.parametrize("crate", CRATES_OF_MODELS)
def test_results_have_the_bits_of_the_c(
    crate: str, printed: Mapping[Any, Any], sources: dict[str, kg.Source]
) -> None:
    source = sources[crate]
    library = kg.library.load(source, on_status="raise")
    for state in range(STATES):
        values = inputs_of(source, state)
        for function in source.functions:
            if len(function.outputs) > 1 or function.name == "prepare":
                continue
            given = {a.name: values[a.name] for a in function.inputs if a.name != PREPARED}
            expected = getattr(library, function.name)(**given)
            (found,) = printed[crate, state, function.name]
            assert np.array_equal(found.astype(expected.dtype), expected), (state, function.name)


@pytest.mark.embed("cargo")
@pytest.mark.parametrize("crate", ["double_pendulum", "double_pendulum_f32", "satellite", "free_body"])
def test_results_are_those_of_the_reference(
    crate: str, printed: Mapping[Any, Any], sources: dict[str, kg.Source]
) -> None:
    """Sums of a few dozen terms: some hundred roundings of the largest entry, none of which cancels."""
    source = sources[crate]
    tolerance = 1e-4 if source.precision == "float" else 1e-12
    for state in range(STATES):
        values = {name: value[None] for name, value in inputs_of(source, state).items()}
        x, loads = values["x"], {k: v for k, v in values.items() if k in ("force", "torque", "point_force")}
        expected = {
            "mass_matrix": mass_matrix(source.system, x)[0],
            "forcing": forcing(source.system, x, values["y"], **loads)[0],
        }
        for name, value in expected.items():
            (found,) = printed[crate, state, name]
            assert np.abs(found - value).max() <= tolerance * np.abs(value).max(), (state, name)


STATUSES = """
use double_pendulum::{names, Error, Model, Parameters, Place, Status};
use std::error::Error as _;

fn main() {
    let short = Parameters { l1: 0.0, ..Parameters::default() };
    let model = Model::new(&short).unwrap();
    let x = [0.1, 0.2];
    let found = model.forward_dynamics(&x, &x, &x).unwrap_err();
    let place = Place::Freedom(0);
    assert_eq!(found, Status::Missing { function: "forward_dynamics", place });
    println!("{found}");
    assert!(found.source().is_none());
    assert_eq!(names::FREEDOM_NAMES[1], "q2");
    assert_eq!(names::SPEED_UNITS, ["rad/s"; 2]);

    let infinite = Parameters { g: f64::INFINITY, ..Parameters::default() };
    println!("{}", Model::new(&infinite).unwrap_err());

    let model = Model::new(&Parameters::default()).unwrap();
    let mut f = [0.0; 2];
    let found = model.forcing_into(&[f64::NAN, 0.0], &x, &mut f).unwrap_err();
    assert_eq!(found, Status::NotFinite { function: "forcing" });
    assert!(f[0].is_nan());

    let mut rows = [[0.0; 2]; 3];
    let found = model.forcing_batch(&[x; 3], &[x; 2], &mut rows).unwrap_err();
    assert_eq!(found, Error::Rows { array: "y", found: 2, expected: 3 });
    println!("{found}");
    assert_eq!(model.forcing_batch(&[x; 2], &[x; 2], &mut rows), Err(found).or(Err(Error::Rows {
        array: "f", found: 3, expected: 2 })));
    let found = model.forcing_batch(&[x, [f64::NAN; 2], x], &[x; 3], &mut rows).unwrap_err();
    assert_eq!(found, Error::States { function: "forcing", failed: 1, count: 3 });
    println!("{found}");
    assert_eq!(model.forcing(&x, &x), Ok(rows[2]));
    assert_eq!(model.forcing_batch(&[], &[], &mut []), Ok(()));

    let (mut x_path, mut y_path, mut made) = ([x; 6], [x; 6], 0);
    let mut go = |tau: &[[f64; 2]], steps, every, kept: usize| {
        let (x_path, y_path) = (&mut x_path[..kept], &mut y_path[..kept]);
        model.rollout_rk4(&x, &x, tau, 0.01, steps, every, false, x_path, y_path, &mut made)
    };
    assert_eq!(go(&[], 10, 2, 6), Ok(()));
    assert_eq!(go(&[x; 21], 10, 2, 6), Ok(()));
    assert_eq!(go(&[], 10, 0, 6), Err(Error::Every));
    assert_eq!(go(&[], 10, 3, 6), Err(Error::Rows { array: "x_path", found: 6, expected: 4 }));
    assert_eq!(go(&[x; 4], 10, 2, 6), Err(Error::Rows { array: "tau", found: 4, expected: 10 }));
    let huge = usize::MAX;
    assert!(matches!(go(&[], huge, 1, 6), Err(Error::Rows { array: "x_path", found: 6, .. })));
    println!("{:?}", go(&[[f64::INFINITY, 0.0]], 10, 2, 6).unwrap_err());
    assert_eq!(made, 0);

    let mut made = [0; 2];
    let (mut x_path, mut y_path) = ([x; 12], [x; 12]);
    let tau = [x; 20];
    let both = [x; 2];
    let found = model.rollout_rk4_batch(
        &both, &both, &tau, 0.01, 10, 2, false, &mut x_path, &mut y_path, &mut made);
    assert_eq!(found, Ok(()));
    assert_eq!(made, [10, 10]);
    assert_eq!(x_path[..6], x_path[6..]);
    let found = model.rollout_rk4_batch(
        &both, &both, &tau[..3], 0.01, 10, 2, false, &mut x_path, &mut y_path, &mut made);
    assert_eq!(found, Err(Error::Rows { array: "tau", found: 3, expected: 2 }));

    let zero = satellite::Model::new().forward_dynamics(
        &[0.0; 9], &[0.0; 8], &[0.0; 8], &[[0.0; 3]; 3], &[[0.0; 3]; 3]);
    println!("{}", zero.unwrap_err());
}
"""


@pytest.mark.embed("cargo")
def test_statuses_and_wrong_arguments(crates: Path, tmp_path: Path, target: Path) -> None:
    names = ["double_pendulum", "satellite"]
    folder = program(tmp_path / "program", crates, names, STATUSES)
    lines = cargo("run", "--quiet", folder=folder, target=target).splitlines()
    assert lines[:4] == [
        'forward_dynamics: the pivot of [A] at freedom "q1" of body "upper" is not positive or is NaN: '
        "[A] is singular, or an input is infinite or NaN",
        "prepare: a result is infinite or NaN",
        "array y has 2 rows, not 3",
        "forcing: 1 of 3 states have a status other than 0",
    ]
    assert lines[4] == 'Status(NotFinite { function: "rollout_rk4" })' or "Missing" in lines[4]
    assert lines[5].startswith("forward_dynamics: ")


@pytest.mark.embed("cargo")
@pytest.mark.parametrize("crate", ["double_pendulum", "double_pendulum_f32", "satellite"])
def test_the_crate_passes_its_own_tests_without_warnings(crate: str, crates: Path, target: Path) -> None:
    folder = crates / crate / "rust"
    assert "test result: ok" in cargo("test", folder=folder, target=target)
    cargo("clippy", "--all-targets", "--", "-D", "warnings", folder=folder, target=target)
    cargo("doc", "--no-deps", folder=folder, target=target, RUSTDOCFLAGS="-D warnings")
    assert cargo("fmt", "--check", folder=folder, target=target) == ""
    assert "Ok(" in cargo("run", "--quiet", "--example", "evaluate", folder=folder, target=target)


@pytest.mark.embed("cargo")
def test_every_output_and_parameters_by_state(tmp_path: Path, target: Path) -> None:
    system = kg.load(PENDULUM)
    outputs = [*available(system), "rollout_rk4", "step_rk4_derivatives"]
    source = kg.generate(system, outputs, artifacts="rust", parameters_by_state=True)
    source.write(tmp_path / "crate")
    folder = tmp_path / "crate" / "rust"
    assert f"{len(source.functions) - 1} passed" in cargo("test", folder=folder, target=target)
    cargo("clippy", "--", "-D", "warnings", folder=folder, target=target)
    assert cargo("fmt", "--check", folder=folder, target=target) == ""


@pytest.mark.embed("cargo")
def test_without_batches(tmp_path: Path, target: Path) -> None:
    outputs = (*DYNAMICS, "rollout_rk4")
    source = kg.generate(kg.load(PENDULUM), outputs, artifacts="rust", batches=False)
    source.write(tmp_path / "crate")
    folder = tmp_path / "crate" / "rust"
    cargo("clippy", "--all-targets", "--", "-D", "warnings", folder=folder, target=target)
    assert not any("batch" in text for name, text in source.files.items() if name.endswith(".rs"))


def test_precisions_without_a_type_in_rust_are_refused() -> None:
    system = kg.load(PENDULUM)
    with pytest.raises(OptionError, match=r"rust: Rust has no numbers in long double, .* --storage double"):
        kg.generate(system, precision="long double", artifacts="rust")
    assert "rust" in kg.generate(system, tier=kg.Variant(precision="double-double")).artifacts


@pytest.mark.parametrize("name", ["match", "crate", "test", "core", "build", "Self", "async"])
def test_names_that_rust_or_cargo_reserve_are_changed(name: str) -> None:
    assert name in RESERVED["rust"] | CRATES
    system = kg.load(PENDULUM).with_name(name)
    found = kg.generate(system, artifacts="rust").files["rust/Cargo.toml"]
    assert f'name = "{crate_name(name, "double")}"' in found
    assert crate_name(name, "double") == f"{name}_model"


AWKWARD = """
name = '3 Arms \\ "left"'
gravity = [0, 0, -9.81]

[parameters]
type = 3.0
self = 3.141592653589793
Self = 2.7
m_1 = 2.0

[[body]]
name = 'links [A](x) `b` <c>'
connection = "ground"
mass = "m_1"
inertia = ["type", "self", "Self"]
mass_center = [0.1, 0, 0]
joint = { free = ["theta1", "theta2"] }
loads = true
"""


@pytest.mark.embed("cargo")
def test_names_of_any_kind(tmp_path: Path, target: Path) -> None:
    (tmp_path / "awkward.toml").write_text(AWKWARD)
    source = kg.generate(kg.load(tmp_path / "awkward.toml"), DYNAMICS, artifacts="rust")
    source.write(tmp_path / "crate")
    folder = tmp_path / "crate" / "rust"
    cargo("test", folder=folder, target=target)
    cargo("clippy", "--all-targets", "--", "-D", "warnings", folder=folder, target=target)
    cargo("doc", "--no-deps", folder=folder, target=target, RUSTDOCFLAGS="-D warnings")
    structs = source.files["rust/src/structs.rs"]
    assert all(f"pub {name}: f64" in structs for name in ("type_", "self_", "Self_", "m_1"))


def test_no_line_of_documentation_becomes_a_list_or_a_link() -> None:
    text = "- [A]{ydot} <b> " + "word " * 15 + "- {f} 2. end"
    lines = doc(text, bullet="- `a`: ")
    assert lines[0].startswith(r"/// - `a`: \- \[A\]{ydot}")
    assert all(line.startswith("///   ") and not line.startswith("///   - ") for line in lines[1:])


def test_columns_of_derivatives_are_those_of_the_library() -> None:
    system = kg.load(MODELS / "cart_pole.toml")
    library = kg.build(system, [name for name in available(system) if name.endswith("_derivatives")])
    text = kg.generate(system, library.source.outputs, artifacts="rust").files["rust/src/columns.rs"]
    modules = dict(re.findall(r"pub mod (\w+) \{(.*?)^\}", text, flags=re.M | re.S))
    for name in library.source.outputs:
        parts = re.findall(r"pub const (\w+): Range<usize> = (\d+)\.\.(\d+);", modules[name])
        found = {by.lower(): slice(int(first), int(last)) for by, first, last in parts}
        assert found == library.derivative_columns(name), name


def test_the_same_bytes_again() -> None:
    assert source_of("satellite").files == source_of("satellite").files


BARE = """\
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use satellite_f32::Model;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}

#[entry]
fn main() -> ! {
    let (model, x, y) = (Model::new(), [0.3; 9], [0.2; 8]);
    let (tau, force, torque) = ([0.1; 8], [[0.0; 3]; 3], [[0.0; 3]; 3]);
    hprintln!("{:?}", model.forward_dynamics(&x, &y, &tau, &force, &torque).unwrap());
    debug::exit(debug::EXIT_SUCCESS);
    loop {}
}
"""

CORTEX = "thumbv7em-none-eabihf"

MACHINE = "MEMORY { FLASH : ORIGIN = 0, LENGTH = 4M RAM : ORIGIN = 0x20000000, LENGTH = 4M }"
"""Memory of the machine mps2-an386 of QEMU, a Cortex-M4F."""


@pytest.mark.embed("cargo", "rustup", "arm-none-eabi-gcc", "qemu-system-arm")
def test_a_bare_machine_computes_the_same_bits(tmp_path: Path, target: Path) -> None:
    """Nothing but the language's own core library is linked; it brings the square root of quaternions."""
    system, outputs = kg.load(MODELS / "satellite.toml"), ("forward_dynamics",)
    kg.generate(system, outputs, artifacts="rust", precision="float").write(tmp_path / "satellite_f32")
    folder = program(tmp_path / "bare", tmp_path, ["satellite_f32"], BARE)
    with (folder / "Cargo.toml").open("a") as file:
        file.write('cortex-m = "0.7"\ncortex-m-rt = "0.7"\ncortex-m-semihosting = "0.5"\n')
    (folder / "memory.x").write_text(MACHINE)
    run(["rustup", "target", "add", CORTEX], folder)
    cargo("build", "--target", CORTEX, folder=folder, target=target, RUSTFLAGS="-C link-arg=-Tlink.x")
    binary = target / CORTEX / "debug" / "program"
    machine = ["qemu-system-arm", "-M", "mps2-an386", "-nographic", "-kernel", str(binary)]
    printed = run([*machine, "-semihosting-config", "enable=on,target=native"], folder)
    library = kg.build(system, outputs, precision="float")
    expected = library.forward_dynamics(np.full(9, 0.3), np.full(8, 0.2), np.full(8, 0.1))
    assert np.array_equal(np.array(ast.literal_eval(printed), np.float32), expected)


@pytest.mark.embed("cargo")
def test_the_page(tmp_path: Path, target: Path) -> None:
    (tmp_path / "models").symlink_to(MODELS)
    for command in blocks("embedding/rust", "sh"):
        run(command.strip(), tmp_path)
    (needs,) = blocks("embedding/rust", "toml")
    package = '[package]\nname = "page"\nversion = "0.1.0"\nedition = "2021"\ndefault-run = "page"\n\n'
    second = 'double_pendulum = { path = "double_pendulum/rust" }\n'
    (tmp_path / "Cargo.toml").write_text(package + needs + second)
    for name, text in files("embedding/rust").items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    assert len(files("embedding/rust")["src/main.rs"].splitlines()) - 2 <= 5  # what a user writes
    (line,) = cargo("run", "--quiet", folder=tmp_path, target=target).splitlines()
    library = kg.build(kg.load(MODELS / "panda_arm.toml"), ("forward_dynamics",))
    expected = library.forward_dynamics(np.full(7, 0.1), np.zeros(7), np.zeros(7))
    assert np.array_equal(ast.literal_eval(line), expected)
    printed = cargo("run", "--quiet", "--bin", "pendulum", folder=tmp_path, target=target).splitlines()
    heavy = kg.build(kg.load(PENDULUM), ("forward_dynamics", "rollout_rk4")).with_parameters({"m2": 0.8})
    state = np.array([0.5, 0.6])
    assert np.array_equal(ast.literal_eval(printed[0]), heavy.forward_dynamics(state, state, state))
    motion = heavy.rollout([0.1, 0.2], [0, 0], [0.5, 0.0], steps=1000, step=1e-3, every=100, method="rk4")
    assert printed[1] == f"q1 = {motion.x[-1, 0]:.3f} rad"
