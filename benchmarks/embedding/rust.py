"""Rust: calls of the methods of a crate that return an array, fill one, and fill those of many states."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

import kanegen as kg
from benchmarks.embedding import arm
from benchmarks.embedding.alone import in_c
from benchmarks.embedding.answering import answering
from benchmarks.embedding.row import SECONDS, Row, in_turns
from kanegen.errors import MissingError
from kanegen.options import Variant

CALLS = {"result returned": "returned", "result in place": "in_place"}
"""Calls by their description."""

PROGRAM = """\
use std::hint::black_box;
use std::time::Instant;

fn turn(mut call: impl FnMut()) -> f64 {{
    let mut count = 1u64;
    loop {{
        let start = Instant::now();
        for _ in 0..count {{
            call();
        }}
        let taken = start.elapsed().as_secs_f64();
        if taken >= {seconds} {{
            return 1e9 * taken / count as f64;
        }}
        count *= 2;
    }}
}}

fn main() {{
    let model = panda_arm::Model::new();
    let x: [f64; 7] = {x};
    let y: [f64; 7] = {y};
    let tau: [f64; 7] = {tau};
    let mut result = [0.0; 7];
    for line in std::io::stdin().lines() {{
        let taken = match line.unwrap().as_str() {{
            "returned" => turn(|| {{
                let _ = black_box(model.forward_dynamics(black_box(&x), &y, &tau));
            }}),
            _ => turn(|| {{
                let _ = black_box(model.forward_dynamics_into(black_box(&x), &y, &tau, &mut result));
            }}),
        }};
        println!("{{taken}}");
    }}
}}
"""

PACKAGE = """\
[package]
name = "turns"
version = "0.1.0"
edition = "2021"

[dependencies]
panda_arm = { path = "panda_arm/rust" }
"""


def measure() -> list[Row]:
    """Measure accelerations of panda_arm; the crate is compiled for every processor, as the C alone.

    Raises:
        MissingError: If Cargo is not installed.
    """
    if shutil.which("cargo") is None:
        raise MissingError("Cargo is not installed (https://rustup.rs)")
    system = kg.load("models/panda_arm.toml")
    source = kg.generate(system, ("forward_dynamics",), tier=Variant(machine="portable"), artifacts="rust")
    inputs = arm.states()
    version = subprocess.run(["rustc", "--version"], capture_output=True, text=True, check=True).stdout
    alone = in_c(source, "forward_dynamics", inputs)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source.write(folder / "panda_arm")
        (folder / "src").mkdir()
        text = PROGRAM.format(seconds=SECONDS, **{one: value.tolist() for one, value in inputs.items()})
        (folder / "src" / "main.rs").write_text(text)
        (folder / "Cargo.toml").write_text(PACKAGE)
        subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=folder, check=True)
        with answering(["target/release/turns"], folder) as turns:
            return [
                Row("Rust", f"{how}, {arm.WHAT}", *in_turns(alone, turns(call)), _words(version))
                for how, call in CALLS.items()
            ]


def _words(version: str) -> str:
    """Return name and number of a version, without its date."""
    return " ".join(version.split()[:2])
