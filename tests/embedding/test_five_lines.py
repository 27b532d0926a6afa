"""Five lines in each program give accelerations of the Panda arm: those of the page, run as they stand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import kanegen as kg
from tests.support.pages import copy_of_checkout, files, run
from tests.support.paths import MODELS

LINES = files("embedding")
"""The blocks of the page by target."""

X = np.array([0.1, -0.8, 0.2, -2.3, 0.3, 1.6, 0.8])
Y = np.array([0.5, -0.4, 0.3, -0.2, 0.1, 0.2, -0.3])
TAU = np.array([1.0, -20.0, 3.0, 10.0, -0.5, 0.6, 0.7])

ROUNDING = 1e-10
"""Relative difference of accelerations: programs with other outputs round otherwise, and [A] amplifies it."""


@pytest.fixture(scope="module")
def expected() -> NDArray[np.float64]:
    """Accelerations by the reference."""
    system = kg.load(MODELS / "panda_arm.toml")
    found: NDArray[np.float64] = kg.build(system, ("forward_dynamics",)).forward_dynamics(X, Y, TAU)
    return found


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(copy_of_checkout(tmp_path))
    return tmp_path


def test_each_takes_at_most_five_lines() -> None:
    assert {"casadi", "jax", "torch", "fmi", "cpp", "rust", "wasm"} == set(LINES)
    for name, text in LINES.items():
        assert sum(bool(line.strip()) for line in text.splitlines()) <= 5, name


def executed(name: str, **arrays: Any) -> dict[str, Any]:
    """Run the lines of a target in Python, with arrays by name, and return what they define."""
    scope = {"x": X, "y": Y, "tau": TAU, **arrays}
    exec(compile(LINES[name], f"docs/embedding.md, {name}", "exec"), scope)
    return scope


def generated(folder: Path) -> None:
    model, targets = "models/panda_arm.toml", "cpp,rust,wasm"
    run(f"kanegen generate {model} --output forward_dynamics --for {targets} -o build/panda", folder)


def declared(form: str) -> list[str]:
    """Return the declarations of x, y and tau in a language, whose form has a name and numbers."""
    return [
        form.format(name=name, numbers=", ".join(map(repr, values.tolist())))
        for name, values in (("x", X), ("y", Y), ("tau", TAU))
    ]


def require_equal(found: Any, expected: NDArray[np.float64]) -> None:
    assert np.allclose(np.ravel(found), expected, rtol=ROUNDING, atol=0.0)


@pytest.mark.embed
def test_casadi(checkout: Path, expected: NDArray[np.float64]) -> None:
    require_equal(executed("casadi")["ydot"].full(), expected)


@pytest.mark.embed("jax")
def test_jax(checkout: Path, expected: NDArray[np.float64]) -> None:
    require_equal(executed("jax")["ydot"], expected)


@pytest.mark.embed("torch")
def test_torch(checkout: Path, expected: NDArray[np.float64]) -> None:
    import torch  # noqa: PLC0415 - of an extra

    arrays = {name: torch.from_numpy(value) for name, value in (("x", X), ("y", Y), ("tau", TAU))}
    require_equal(executed("torch", **arrays)["ydot"], expected)


@pytest.mark.embed
def test_fmi(checkout: Path) -> None:
    motion = executed("fmi")["motion"]
    system = kg.load(MODELS / "panda_arm.toml")
    trajectory = kg.simulate(system, X, times=[0.0, 1.0], step=1e-3)
    end = [motion[f"x.{name}"][-1] for name in system.freedom_names]
    assert np.allclose(end, trajectory.x[-1], rtol=0.0, atol=1e-3)  # the solver of FMPy keeps 1e-5 a step


@pytest.mark.embed
def test_cpp(checkout: Path, expected: NDArray[np.float64]) -> None:
    generated(checkout)
    include, *lines = LINES["cpp"].splitlines()
    arrays = declared("const std::array<double, 7> {name}{{{numbers}}};")
    out = 'for (double one : ydot) std::printf("%.17g\\n", one);'
    main = ["#include <array>", "#include <cstdio>", include, "int main()", "{", *arrays, *lines, out, "}"]
    (checkout / "use.cpp").write_text("\n".join([*main, ""]))
    run("cc -O2 -ffp-contract=off -c build/panda/panda_arm.c", checkout)
    run("c++ -std=c++17 -Ibuild/panda use.cpp panda_arm.o -o use", checkout)
    require_equal([float(line) for line in run("./use", checkout).split()], expected)


@pytest.mark.embed("cargo")
def test_rust(checkout: Path, expected: NDArray[np.float64]) -> None:
    generated(checkout)
    head, *arrays = "fn main() -> Result<(), panda_arm::Status> {", *declared("let {name} = [{numbers}];")
    out = 'for one in ydot { println!("{one:?}"); } Ok(()) }'
    (checkout / "src").mkdir()
    (checkout / "src" / "main.rs").write_text("\n".join([head, *arrays, LINES["rust"], out, ""]))
    (checkout / "Cargo.toml").write_text(
        '[package]\nname = "use"\nversion = "1.0.0"\nedition = "2021"\n\n'
        '[dependencies]\npanda_arm = { path = "build/panda/rust" }\n'
    )
    require_equal([float(line) for line in run("cargo run --quiet", checkout).split()], expected)


@pytest.mark.embed("node")
def test_wasm(checkout: Path, expected: NDArray[np.float64]) -> None:
    generated(checkout)
    arrays = declared("const {name} = [{numbers}];")
    (checkout / "use.mjs").write_text("\n".join([*arrays, LINES["wasm"], "console.log(ydot.join(' '));", ""]))
    require_equal([float(word) for word in run("node use.mjs", checkout).split()], expected)
