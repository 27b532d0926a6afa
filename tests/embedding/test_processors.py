"""Processors: older ones of x86-64 run the version that they can, and NEON gives the bits of x86-64."""

from __future__ import annotations

import re

import pytest

import kanegen as kg
from kanegen.library.native.build import code, write
from tests.battery import bits, scenes, targets
from tests.battery.state_classes import State, states
from tests.support.c_compilers import ZIG, run
from tests.support.cases import slow_except

ARM = scenes.planar([1.0] * 6)
"""Six hinges, whose sines one state computes in vectors."""

ARM64 = "aarch64-linux-gnu-gcc"

PRECISIONS = ("double", "float")


def made(precision: str, machine: str = "auto") -> kg.c.Source:
    """Return the C of the arm."""
    return kg.generate(ARM, bits.OUTPUTS, tier=kg.Variant(precision=precision, machine=machine))


def expected(precision: str) -> tuple[State, str]:
    """Return states of eight classes, and the bits of portable code for x86-64 in them."""
    source = made(precision)
    state = states(ARM, bits.storage(source), 4, 40, targets.classes(source.variant))
    return state, bits.printed(source, state, "gcc", "-O2")


CHOICE = """
#include <stdio.h>
#include "planar.c"
int main(void) { return printf("%d", kanegen_bits()) < 0; }
"""


@pytest.mark.embed("qemu-x86_64")
@pytest.mark.parametrize(
    ("processor", "width"), [("qemu64", 128), ("Nehalem", 128), ("SandyBridge", 128), ("Haswell", 256)]
)
def test_older_processors_run_the_version_that_they_can(processor, width, tmp_path):
    """An emulated processor refuses every instruction that it lacks."""
    emulator = f"qemu-x86_64 -cpu {processor}"
    state, found = expected("double")
    assert bits.printed(made("double", "multiversioned"), state, "gcc", "-O2", emulator) == found
    write({**code(made("double", "multiversioned")), "choice.c": CHOICE}, tmp_path)
    run("gcc", "-O1", "choice.c", "-lm", "-o", "choice", folder=tmp_path)
    assert int(run(*emulator.split(), "./choice", folder=tmp_path)) == width


@pytest.mark.embed("qemu-x86_64")
def test_code_for_a_later_processor_does_not_run_on_an_older_one():
    """So the emulator does refuse what a processor lacks."""
    state, _ = expected("double")
    with pytest.raises(kg.BuildError, match=r"failed with status -4"):  # SIGILL
        bits.printed(made("double"), state, "gcc", "-O2 -mavx2", "qemu-x86_64 -cpu SandyBridge")


@pytest.mark.embed("qemu-aarch64", ARM64)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("lanes", slow_except(["", "1", "2", "4", "8"], "", "1"))
def test_neon_has_the_bits_of_x86_64(precision, lanes):
    flags = f"-static -O2 {f'-DKANEGEN_LANES={lanes}' if lanes else ''}"
    state, found = expected(precision)
    assert bits.printed(made(precision), state, ARM64, flags, "qemu-aarch64") == found


@pytest.mark.embed("qemu-aarch64", ARM64)
def test_multiversioned_code_fuses_nothing_on_other_processors_either():
    """gcc for aarch64 fuses products and sums unless it is told not to."""
    state, found = expected("double")
    source = made("double", "multiversioned")
    assert bits.printed(source, state, ARM64, "-static -O2 -ffp-contract=fast", "qemu-aarch64") == found


@pytest.mark.embed(ARM64)
@pytest.mark.parametrize(("precision", "lanes"), [("double", "2d"), ("float", "4s")])
def test_batches_are_instructions_of_neon(precision, lanes, tmp_path):
    """Almost all arithmetic of a batch is in vectors, which the usual flags of the architecture allow."""
    write(code(made(precision)), tmp_path)
    flags = ["-std=c99", "-O2", "-ffp-contract=off", "-S", "-o", "-"]
    text = run(ARM64, *flags, "planar_batch.c", folder=tmp_path)
    vectors = re.findall(rf"\t(?:fmul|fadd|fsub)\tv\d+\.{lanes}", text)
    single = re.findall(r"\t(?:fmul|fadd|fsub)\t[ds]\d", text)
    assert len(vectors) > 100 and len(vectors) > 5 * len(single)


@pytest.mark.embed("wine")
def test_windows_runs_the_widest_version(tmp_path):
    """The compiler is clang with the runtime library of zig, which has no other way to ask the processor."""
    write({**code(made("double", "multiversioned")), "choice.c": CHOICE}, tmp_path)
    run(*ZIG, "cc", "-target", "x86_64-windows-gnu", "-O1", "choice.c", "-o", "choice.exe", folder=tmp_path)
    run("gcc", "choice.c", "-lm", "-o", "choice", folder=tmp_path)
    assert run("wine", "choice.exe", folder=tmp_path) == run("./choice", folder=tmp_path)
