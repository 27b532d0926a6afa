"""docs/truth: its readers work; the reference finds its numbers, and Pinocchio from the files alone."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from benchmarks.validation import truth
from kanegen.model.arrays import Floats
from kanegen.reference import equations as reference
from tests.support.c_compilers import WARNINGS, C
from tests.support.paths import ROOT

FILES = ROOT / "docs" / "truth"
README = (FILES / "README.md").read_text(encoding="utf-8")
CLOSE = 1e-12
"""Largest error over the largest entry: rounding in double precision, of at most 48 freedoms."""


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


@pytest.mark.parametrize("name", truth.NAMES)
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
    tree = READ(FILES / f"{name}.json")
    model = PinocchioModel(tree)
    for state in tree["states"]:
        a, f = model.dynamics(state["x"], state["y"])
        assert_close(a, state["A"])
        assert_close(f, state["f"])


class PinocchioModel:
    """A tree of a file in Pinocchio: a joint for every entry of `joint`, and a projection for couplings."""

    def __init__(self, tree: dict[str, Any]) -> None:
        self.model = pin.Model()
        self.model.gravity.linear = self.vector(tree["gravity"])
        self.freedoms = len(tree["speeds"])
        self.moves: list[tuple[int, dict[str, Any]]] = []
        joints = {0: 0}
        for k, body in enumerate(tree["bodies"], start=1):
            turned = self.vector(body["orientation"]).reshape(3, 3)
            placement = pin.SE3(turned.T, self.vector(body["position"]))
            joint = joints[body["lower"]]
            for move in body["joint"]:
                joint = self.model.addJoint(joint, self.kind(move), placement, f"{k}.{len(self.moves)}")
                self.moves.append((joint, move))
                placement = pin.SE3.Identity()
            inertia = self.vector(body["inertia"]).reshape(3, 3)
            moving = pin.Inertia(NUMBER(body["mass"]), self.vector(body["mass_center"]), inertia)
            self.model.appendBodyToJoint(joint, moving, placement)
            joints[k] = joint

    @staticmethod
    def vector(texts: list[str]) -> Floats:
        return np.array([NUMBER(text) for text in texts])

    @staticmethod
    def kind(move: dict[str, Any]) -> Any:
        if "quaternion" in move:
            return pin.JointModelSpherical()
        letter, axis = ("P", move["slide"]) if "slide" in move else ("R", move["turn"])
        return getattr(pin, f"JointModel{letter}{'XYZ'[axis - 1]}")()

    def dynamics(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """[A] and {f} in the order of the file."""
        q, projection = pin.neutral(self.model), np.zeros((self.model.nv, self.freedoms))
        for joint, move in self.moves:
            at, to = self.model.joints[joint].idx_q, self.model.joints[joint].idx_v
            if "quaternion" in move:
                scalar, *vector = x[move["quaternion"]] / np.linalg.norm(x[move["quaternion"]])
                q[at : at + 4] = *vector, scalar
                projection[range(to, to + 3), move["y"]] = 1
            else:
                factor, offset = NUMBER(move.get("factor", "1")), NUMBER(move.get("offset", "0"))
                q[at] = factor * x[move["x"]] + offset
                projection[to, move["y"]] = factor
        data = self.model.createData()
        upper = np.triu(pin.crba(self.model, data, q))
        a = upper + np.triu(upper, 1).T
        bias = pin.nonLinearEffects(self.model, data, q, projection @ y)
        return projection.T @ a @ projection, -projection.T @ bias


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
