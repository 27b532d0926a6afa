"""The status of an iteration that does not converge, as programs in other languages see it.

On a spring of frequency 1/s, the iteration of the implicit midpoint rule diverges for steps longer than 2 s.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest

import kanegen as kg
from kanegen.c.folder import write
from kanegen.products import compiled_files
from tests.support.c_compilers import CPP, C, run
from tests.support.fmu import CALL_FAILED, CO_SIMULATION, Instance
from tests.support.octave import octave
from tests.support.oscillator import oscillator

STEP = "step_implicit_midpoint"

CPP_PROGRAM = """#include <cstdio>
#include "slider.hpp"

using namespace kanegen;

int main()
{
    slider::model object;
    std::array<double, 1> x{0.3}, y{0.0}, tau{0.0};
    try { (void)object.step_implicit_midpoint(x, y, tau, 1.2); std::puts("made"); }
    catch (const slider::error &e) { std::puts(e.what()); }
    try { (void)object.step_implicit_midpoint(x, y, tau, 2.5); }
    catch (const slider::error &e) {
        const bool is_known = e.found().kind() == slider::outcome::not_converged;
        std::printf("%s, %d, %d\\n", e.what(), is_known, e.found().place().empty());
    }
    return 0;
}
"""

RUST_PROGRAM = """use slider::{Model, Status};

fn main() {
    let model = Model::new();
    println!("{}", model.step_implicit_midpoint(&[0.3], &[0.0], &[0.0], 1.2).is_ok());
    let status = model.step_implicit_midpoint(&[0.3], &[0.0], &[0.0], 2.5).unwrap_err();
    println!("{} {}", matches!(status, Status::NotConverged { .. }), status);
}
"""


def written(artifact: str, folder: Path) -> kg.Source:
    source = kg.generate(oscillator(), (STEP,), artifacts=artifact)
    source.write(folder)
    return source


def test_cpp(tmp_path: Path) -> None:
    source = written("cpp", tmp_path)
    (tmp_path / "use.cpp").write_text(CPP_PROGRAM)
    run(*C["gcc"], "-std=c99", "-c", "slider.c", folder=tmp_path)
    run(
        *CPP["g++"],
        "-std=c++17",
        "-Wall",
        "-Werror",
        "use.cpp",
        "slider.o",
        "-lm",
        "-o",
        "use",
        folder=tmp_path,
    )
    made, failed = run("./use", folder=tmp_path).splitlines()
    words = "slider::step_implicit_midpoint: the iteration for the step does not converge"
    assert (made, failed) == ("made", f"{words} (status {source.model.not_converged}), 1, 1")


@pytest.mark.embed("cargo")
def test_rust(tmp_path: Path) -> None:
    written("rust", tmp_path / "slider")
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "main.rs").write_text(RUST_PROGRAM)
    (tmp_path / "Cargo.toml").write_text(
        '[package]\nname = "program"\nversion = "0.1.0"\nedition = "2021"\n\n'
        '[dependencies]\nslider = { path = "slider/rust" }\n'
    )
    environment = {**os.environ, "CARGO_TERM_COLOR": "never"}
    done = subprocess.run(
        ["cargo", "run", "-q"], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    made, failed = done.stdout.splitlines()
    assert made == "true"
    assert failed.startswith("true step_implicit_midpoint: the iteration for the step does not converge")


@pytest.mark.embed("octave", "mkoctfile")
def test_octave(tmp_path: Path) -> None:
    source = written("octave", tmp_path)
    script = """
    slider.build();
    [x, y, status] = slider.step_implicit_midpoint(0.3, 0, 0, 2.5);
    disp(status)
    try
        slider.step_implicit_midpoint(0.3, 0, 0, 2.5);
    catch problem
        disp(problem.identifier)
    end
    """
    printed = octave(script, tmp_path)
    assert str(source.model.not_converged) in printed.split()
    assert "kanegen:slider:notConverged" in printed


@pytest.mark.embed("node")
def test_webassembly(tmp_path: Path) -> None:
    source = kg.generate(oscillator(), (STEP,), artifacts=["wasm"])
    write({**source.files, **compiled_files(source, ["wasm"])}, tmp_path)
    script = """
    import { load } from "./slider.js";
    const model = await load();
    model.step_implicit_midpoint([0.3], [0], [0], 1.2);
    try { model.step_implicit_midpoint([0.3], [0], [0], 2.5); }
    catch ({ name, kind, status }) { console.log(JSON.stringify([name, kind, status])); }
    """
    (tmp_path / "wasm" / "use.mjs").write_text(script)
    done = subprocess.run(
        ["node", "use.mjs"], cwd=tmp_path / "wasm", capture_output=True, text=True, check=True
    )
    assert json.loads(done.stdout) == ["StatusError", "not converged", source.model.not_converged]


@pytest.mark.slow
def test_an_fmu(tmp_path: Path) -> None:
    source = kg.generate(
        oscillator(), ("forward_dynamics", "rollout_rk4", "rollout_implicit_midpoint"), artifacts=["fmi3"]
    )
    path = kg.export(source, "fmi3", tmp_path / "slider.fmu")
    with Instance(path, CO_SIMULATION) as one:
        one.initialize({"x.slider.s1": 0.3, "step": 2.5})
        with pytest.raises(CALL_FAILED):
            one.step(0.0, 2.5)
        assert "step_implicit_midpoint: the iteration for the step does not converge" in one.log[-1][2]
