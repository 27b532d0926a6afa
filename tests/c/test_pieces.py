"""Long files in pieces: the bits, names and warnings of a file that is compiled as a whole."""

from __future__ import annotations

import re
import shlex
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.c import pieces
from kanegen.c.c99 import C99_TARGET
from kanegen.c.pieces import divided, number_of_pieces
from kanegen.c.target import Target
from kanegen.library import load
from kanegen.library.native.build import Recipe, code, write
from kanegen.lowering import solution_columns
from kanegen.program.ir import Instruction, Op, Program
from tests.support.c_compilers import WARNINGS, C, run
from tests.support.cases import slow_except
from tests.support.systems import chain

OUTPUTS = ("forward_dynamics", "forward_dynamics_derivatives", "rollout_rk4")
STATES = 11
FLAGS = "-O0 -ffp-contract=off"
SHORT = replace(C99_TARGET, longest_part=50)
"""The language C with parts of 50 instructions."""

NUMBER = 3
"""Pieces of the files of a divided source."""


@cache
def source(target: Target = SHORT, **choices: str) -> kg.Source:
    """Return C of a chain with loops over columns and with steps, in pieces where its parts are short."""
    variant = kg.Variant(**{"machine": "portable", **choices})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pieces, "LENGTH", 1 if target is SHORT else pieces.LENGTH)
        patch.setattr(pieces, "MOST", NUMBER)
        patch.setattr(solution_columns, "LOOPED", 0)
        return kg.generate(chain(2), OUTPUTS, tier=variant, target=target)


def results(library: kg.Library) -> list[np.ndarray]:
    """Return what all functions compute in random states, one by one and in batches."""
    rng = np.random.default_rng(4)
    x, y, tau = rng.uniform(-1.0, 1.0, (3, STATES, library.n))
    states = [(x, y, tau), *zip(x, y, tau, strict=True)]
    found = [library.evaluate(*state[:2], tau=state[2]) for state in states]
    arrays = [array for one in found for array in one]
    return [
        *arrays,
        *(library.forward_dynamics(*one) for one in states),
        *(library.forward_dynamics_derivatives(*one) for one in states),
        *(library.rollout(*one, steps=3, step=0.01).x for one in states),
    ]


@pytest.mark.parametrize(
    "choices",
    [
        {},
        pytest.param({"machine": "multiversioned"}, marks=pytest.mark.slow),
        pytest.param({"precision": "float", "storage": "double"}, marks=pytest.mark.slow),
        pytest.param({"precision": "double-double"}, marks=pytest.mark.slow),
        pytest.param({"semantics": "flush-to-zero"}, marks=pytest.mark.slow),
    ],
    ids=lambda choices: " ".join(choices.values()) or "portable",
)
def test_pieces_have_the_bits_of_the_whole_and_of_functions_without_parts(choices: dict[str, str]) -> None:
    in_pieces, uncut = source(**choices), source(C99_TARGET, **choices)
    whole = replace(in_pieces, pieces={})
    assert in_pieces.pieces and set(in_pieces.pieces.values()) == {NUMBER}
    assert not uncut.pieces
    found, *others = (results(load(one, flags=FLAGS)) for one in (in_pieces, whole, uncut))
    for wanted in others:
        assert [one.tobytes() for one in found] == [one.tobytes() for one in wanted]
    assert all(np.isfinite(one).all() for one in found)


def test_a_library_of_pieces_exports_what_that_of_whole_files_does() -> None:
    in_pieces = source()
    names = []
    for one in (in_pieces, replace(in_pieces, pieces={})):
        path = load(one, flags=FLAGS).path
        names.append(set(run("nm", "-D", "--defined-only", path.name, folder=path.parent).split()[2::3]))
    assert names[0] == names[1]
    assert {"chain_forward_dynamics", "chain_rollout_rk4_batch"} <= names[0]
    assert not [name for name in names[0] if re.search(r"_\d+$", name)]


@pytest.mark.parametrize("machine", ["portable", pytest.param("multiversioned", marks=pytest.mark.slow)])
@pytest.mark.parametrize("compiler", slow_except(C, "gcc"))
def test_no_piece_has_a_warning_and_each_part_is_in_one(compiler: str, machine: str, tmp_path: Path) -> None:
    made = source(machine=machine)
    write(code(made), tmp_path)
    for file, number in made.pieces.items():
        command = [*C[compiler], "-std=c99", *WARNINGS, "-O0", "-c", file]
        flags = [[f"-DKANEGEN_PIECE={k}"] for k in range(number + 1)]
        (functions, _), *found = (defined([*command, *one], tmp_path) for one in flags)
        parts = [of_piece for of_piece, _ in found]
        assert all(parts)
        assert sum(map(len, parts)) == len(set().union(*parts))
        whole, statics = defined(command, tmp_path)
        assert functions == whole
        assert set().union(*parts) <= statics


def defined(command: list[str], folder: Path) -> tuple[set[str], set[str]]:
    """Return the functions that a command compiles, and the static ones."""
    run(*command, "-o", "one.o", folder=folder)
    listed = run("nm", "--defined-only", "one.o", folder=folder)
    return set(re.findall(r" T (chain_\w+)", listed)), set(re.findall(r" t (chain_\w+)", listed))


def test_a_number_without_a_piece_is_an_error(tmp_path: Path) -> None:
    write(code(source()), tmp_path)
    command = [*C["gcc"], f"-DKANEGEN_PIECE={NUMBER + 1}", "-E", "chain.c"]
    with pytest.raises(AssertionError, match=f"not one of the numbers from 0 to {NUMBER}"):
        run(*command, folder=tmp_path)


def test_cmake_and_the_commands_of_the_readme_compile_the_pieces(tmp_path: Path) -> None:
    made = source()
    folder = made.write(tmp_path / "out")
    run("cmake", "-S", ".", "-B", "../build", "-DCMAKE_BUILD_TYPE=Debug", folder=folder)
    built = run("cmake", "--build", "../build", "--parallel", "2", "--verbose", folder=folder)
    assert len(re.findall(r"-c \S+chain(?:_batch)?\.\d\.c", built)) == 2 * (NUMBER + 1)
    run("cmake", "--build", "../build", "--target", "kanegen_chain_example", folder=folder)
    readme = made.files["README.md"].replace("-O2", "-O0")
    for line in re.findall(r"^for i in .*; wait$", readme, re.MULTILINE):
        run("sh", "-c", line, folder=folder)
    objects = [f"{file[:-2]}.{k}.o" for file, number in made.pieces.items() for k in range(number + 1)]
    run(*C["gcc"], "-ffp-contract=off", "main.c", *objects, "-o", "by_hand", "-lm", folder=folder)
    by_hand = run("./by_hand", folder=folder)
    assert by_hand.count(" = ") > 2
    assert by_hand == run("../build/kanegen_chain_example", folder=folder)


def program(instructions: int) -> Program:
    """Return a program of some instructions."""
    return Program((), (Instruction(Op.CONSTANT, number=1.0),) * instructions, ())


def test_only_long_files_are_divided() -> None:
    half = program(pieces.LENGTH)
    assert number_of_pieces([(half, half)]) == 2
    assert number_of_pieces([(half, program(pieces.LENGTH - 1))]) == 0
    assert number_of_pieces([(program(100 * pieces.LENGTH),)]) == 0  # one part, which stays whole
    assert number_of_pieces([(half,) * 100]) == pieces.MOST


def test_pieces_are_as_long_as_each_other() -> None:
    parts = [
        ([f"int part_{k}(void)"], ["    ;"] * length) for k, length in enumerate((40, 40, 20, 60, 80, 80))
    ]
    made = divided(parts, 4)
    assert [part for piece in made.parts for part in piece] == parts
    assert [sum(len(body) for _, body in piece) for piece in made.parts] == [80, 80, 80, 80]
    assert divided(parts, 0).number == 0


def test_the_commands_of_a_library_name_every_piece_once() -> None:
    made = source()
    objects = Recipe(made).product().objects
    selected = [re.findall(r"-DKANEGEN_PIECE=(\d+) -c (\S+)", shlex.join(one)) for one in objects.values()]
    assert selected == [[(str(k), file)] for file in made.pieces for k in range(NUMBER + 1)]
