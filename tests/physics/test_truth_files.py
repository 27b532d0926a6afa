"""docs/truth: its readers work; the reference finds its numbers, and Pinocchio from the files alone."""

from __future__ import annotations

import re
import runpy
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.validation import truth
from kanegen.model.arrays import Floats
from kanegen.reference import equations as reference
from tests.support.c_compilers import WARNINGS, C
from tests.support.cases import slow_among
from tests.support.paths import ROOT

FILES = ROOT / "docs" / "truth"
README = (FILES / "README.md").read_text(encoding="utf-8")
CLOSE = 1e-12
"""Largest error over the largest entry: rounding in double precision, of at most 48 freedoms."""

CONDITION = 1e3
"""Largest factor by which solving with [A] makes errors of accelerations larger than those of [A] and {f}."""


def block(language: str) -> str:
    """The reader of a language in the README."""
    (code,) = re.findall(rf"^```{language}\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)
    return str(code)


def reader() -> dict[str, Any]:
    """The functions of the reader in Python."""
    functions: dict[str, Any] = {}
    exec(block("python"), functions)
    return functions


NUMBER, READ = (reader()[name] for name in ("number", "read"))


def assert_close(found: Floats, expected: Floats) -> None:
    assert np.abs(found - expected).max() <= CLOSE * np.abs(expected).max()


@pytest.mark.parametrize("name", slow_among(truth.NAMES, "eight_body", "talos_reduced"))
def test_files_are_those_that_the_module_writes(name: str) -> None:
    assert truth.text(name) == (FILES / f"{name}.json").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", truth.NAMES)
def test_reference_finds_the_same(name: str) -> None:
    system = truth.system(name)
    for state in READ(FILES / f"{name}.json")["states"]:
        x, y = state["x"], state["y"]
        assert_close(reference.mass_matrix(system, x), state["A"])
        assert_close(reference.forcing(system, x, y), state["f"])
        assert_close(state["A"] @ state["ydot"], state["f"])


@pytest.mark.parametrize("name", truth.NAMES)
def test_pinocchio_finds_the_same_from_the_file_alone(name: str) -> None:
    a, f, ydot = runpy.run_path(str(FILES / "in_pinocchio.py"))["errors"](FILES / f"{name}.json")
    assert max(a, f) <= CLOSE
    assert ydot <= CLOSE * CONDITION


@pytest.mark.parametrize("name", truth.NAMES)
def test_numbers_have_the_digits_that_are_promised(name: str) -> None:
    text = (FILES / f"{name}.json").read_text(encoding="utf-8")
    decimals = [
        one
        for line in text.splitlines()
        if line.startswith(('   "A', '   "f', '   "ydot'))
        for one in re.findall(r'"([^"]*)"', line)[1:]
    ]
    assert len(decimals) > 8 * 27
    for one in decimals:
        digits = one.partition("e")[0].lstrip("-0.").replace(".", "")
        assert one in {"0", "1"} or len(digits) == 32, one


def test_c_reader(tmp_path: Path) -> None:
    """The reader in C, compiled without a warning, reads the arrays of the last state."""
    file = FILES / "panda.json"
    expected = READ(file)["states"][-1]
    main = r"""
#include <stdio.h>
#include <assert.h>

int main(void)
{
    static char text[1 << 20];
    double A[36], f[8];
    const char *next;
    FILE *file = fopen("panda.json", "r");
    assert(file);
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    next = text;
    while (strstr(next, "\"A\":")) {
        next = read_array(next, "\"A\":", A);
        next = read_array(next, "\"f\":", f);
    }
    for (int i = 0; i < 36; i++)
        printf("%.17g\n", A[i]);
    for (int i = 0; i < 8; i++)
        printf("%.17g\n", f[i]);
    assert(!read_array(text, "\"nothing\":", f));
    return 0;
}
"""
    prototype = "const char *read_array(const char *text, const char *key, double *numbers);\n"
    (tmp_path / "reader.c").write_text(prototype + block("c") + main)
    (tmp_path / "panda.json").write_bytes(file.read_bytes())
    command = [*C["gcc"], "-std=c99", *WARNINGS, "reader.c", "-o", "reader"]
    subprocess.run(command, cwd=tmp_path, check=True)
    printed = subprocess.run("./reader", cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    values = [float(line) for line in printed.split()]
    assert values == [*expected["A"][np.tril_indices(8)], *expected["f"]]
