"""The peer dynibo: a library in Rust, which cargo builds from its package and a driver in C calls."""

from __future__ import annotations

import functools
import shutil
from pathlib import Path

from kanegen.errors import MissingError
from kanegen.library.native import cache, commands, processor
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.problem import SINGLE_STATE_TASKS, Builders, Problem
from kanegen.studies.bench.peers.urdf_tree import urdf_tree
from kanegen.studies.bench.settings import CONTRACTED, CONTRACTED_AVX2, Setting, here
from kanegen.studies.bench.states import write_states

DYNIBO = "dynibo"
"""Name of the participant."""

VERSION = "0.5.3"
"""The version of dynibo that is built."""

GRAVITY = 9.80665
"""The gravity of dynibo (m/s^2), a constant of its source."""

BUILD_SECONDS = 900
"""Time limit of cargo, which also fetches packages."""

_PROCESSORS = {CONTRACTED.name: "native", CONTRACTED_AVX2.name: "x86-64-v3"}
"""The processors of compiler settings in the words of rustc."""

_LIBRARY = "libpeer.a"
"""Name of the file that cargo makes."""

_MANIFEST = f"""\
[package]
name = "peer"
version = "0.0.0"
edition = "2024"

[lib]
path = "dynibo.rs"
crate-type = ["staticlib"]

[dependencies]
dynibo = "={VERSION}"

[profile.release]
opt-level = 3
lto = "fat"
codegen-units = 1
panic = "abort"
"""


def builders(problem: Problem) -> Builders:
    """Yield the builder of one participant for each compiler setting."""
    yield DYNIBO, functools.partial(_build, problem)


def _build(problem: Problem) -> list[Participant]:
    """Build the participants of all compiler settings."""
    tree = urdf_tree(problem.system, GRAVITY)
    model = problem.write("dynibo.urdf", tree.text)
    states = write_states(tree.states(problem.states), problem.folder / "dynibo-states")
    found = []
    for setting in here((CONTRACTED, CONTRACTED_AVX2)):
        libraries = (str(_library(setting)), "-lpthread", "-ldl", "-lm")
        program = compiled("dynibo", {"dynibo.c": driver("dynibo.c")}, setting.flags, libraries)
        command = (str(program),)
        found.append(
            Participant(DYNIBO, setting, command, states, SINGLE_STATE_TASKS, (model,), tree.results)
        )
    return found


def cargo() -> str | None:
    """Return the path of cargo, the builder of packages in Rust; None if there is none."""
    return shutil.which("cargo")


def _library(setting: Setting) -> Path:
    """Let cargo build the library for one compiler setting, and return its path in the cache.

    Raises:
        MissingError: If there is no cargo, it fails, or it exceeds its time limit.
    """
    if (program := cargo()) is None:
        raise MissingError("there is no cargo, which builds it (https://rustup.rs)")
    source, target = driver("dynibo.rs"), _PROCESSORS[setting.name]

    def fill(folder: Path) -> None:
        """Build in the folder of the entry, and leave only the library there."""
        (folder / "Cargo.toml").write_text(_MANIFEST, encoding="utf-8")
        (folder / "dynibo.rs").write_text(source, encoding="utf-8")
        (folder / ".cargo").mkdir()
        options = f'[build]\nrustflags = ["-C", "target-cpu={target}"]\n'
        (folder / ".cargo" / "config.toml").write_text(options, encoding="utf-8")
        command = [program, "build", "--release", "--quiet", "--target-dir", "target"]
        try:
            done = commands.run(command, folder=folder, seconds=BUILD_SECONDS)
        except commands.TimeLimitError:
            raise MissingError(f"cargo took more than {BUILD_SECONDS} s") from None
        if done.returncode:
            errors = [line for line in done.stderr.splitlines() if "error" in line]
            raise MissingError(f"cargo failed: {errors[0] if errors else done.returncode}")
        shutil.copy2(folder / "target" / "release" / _LIBRARY, folder / _LIBRARY)
        shutil.rmtree(folder / "target")

    name = cache.key([_MANIFEST, source, target, processor.fingerprint()])
    return cache.use(name, _LIBRARY, fill, Path)
