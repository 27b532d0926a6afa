"""Re-anchoring in C: compiled, against the same in Python."""

from __future__ import annotations

import ctypes
import subprocess
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import OptionError
from kanegen.library.native import compilers
from tests.support import systems
from tests.support.c_compilers import WARNINGS
from tests.support.command import kanegen
from tests.support.reanchoring import near_gimbal_lock, with_orientation_parameters

CALLS = """
#include "tree_reanchor.h"
int reanchor(int body, double *p, double *x, double *y) { return tree_reanchor(body, p, x, y); }
double apart(int body, const double *x) { return tree_apart(body, x); }
"""
U = 2.0**-53


@pytest.fixture(scope="module")
def system() -> kg.System:
    """Three bodies of three sequences: six freedoms, three angles with angular velocities, a fixed frame."""
    drawn, _, _ = near_gimbal_lock("1-2-3", 1, 0.1)
    bodies = list(with_orientation_parameters(drawn).bodies)
    changes: tuple[dict[str, Any], ...] = (
        {"sequence": "3-1-3"},
        {"sequence": "2-3-1", "speeds": "angular_velocity", "free": (True,) * 3 + (False,) * 3},
        {"sequence": "1-2-1", "orientation": np.eye(3)},
    )
    turned = [replace(b, joint=replace(b.joint, **c)) for b, c in zip(bodies, changes, strict=True)]
    return replace(drawn, name="tree", bodies=tuple(turned))


@pytest.fixture(scope="module")
def code(system: kg.System, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The header, compiled with two functions that call it."""
    folder = tmp_path_factory.mktemp("reanchor") / "c"
    source = kg.generate(system, ("mass_matrix",), reanchoring=True)
    source.write(folder)
    (folder / "calls.c").write_text(CALLS)
    line = [
        *compilers.find().command,
        "-std=c99",
        "-O1",
        "-shared",
        "-fPIC",
        "calls.c",
        "-o",
        "calls.so",
        "-lm",
    ]
    subprocess.run(line, cwd=folder, check=True)
    library = ctypes.CDLL(str(folder / "calls.so"))
    library.apart.restype = ctypes.c_double
    return library


def call(code: Any, body: int, *arrays: Any) -> int:
    pointers = [array.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for array in arrays]
    return int(code.reanchor(body, *pointers))


@pytest.mark.parametrize("distance", [0.5, 1e-3, 1e-12])
@pytest.mark.parametrize("body", [1, 2])
def test_it_does_what_python_does(code: Any, system: kg.System, body: int, distance: float) -> None:
    middle = system.freedom_names.index(f"body{body}.theta2")
    for seed in range(5):
        x, y = np.random.default_rng(seed).normal(size=(2, len(system.freedoms)))
        x[middle] = distance if body == 1 else np.pi / 2 - distance
        expected = kg.reanchored(system, x, y, [body])
        parameters = np.array([parameter.value for parameter in system.parameters])
        assert call(code, body, parameters, x, y) == 0
        new = dict(zip(expected.parameters, parameters, strict=True))
        orientations = [s.values().joint_orientation for s in (system.with_parameters(new), expected.system)]
        assert np.abs(orientations[0] - orientations[1]).max() <= 8 * U  # the angles themselves may be free
        assert x == pytest.approx(expected.x, rel=16 * U, abs=16 * U)
        assert y == pytest.approx(expected.y, rel=16 * U, abs=16 * U)


def test_other_bodies_stay(code: Any, system: kg.System) -> None:
    arrays = [np.random.default_rng(1).normal(size=n) for n in (6, 15, 15)]
    before = [array.copy() for array in arrays]
    for body in (3, 0, 4, -1):
        assert call(code, body, *arrays) == 1
        assert np.isnan(code.apart(body, arrays[1].ctypes.data_as(ctypes.POINTER(ctypes.c_double))))
    assert all(np.array_equal(a, b) for a, b in zip(arrays, before, strict=True))


def test_how_far_it_is(code: Any, system: kg.System) -> None:
    x = np.linspace(0.1, 1.5, 15)
    pointer = x.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
    assert code.apart(1, pointer) == pytest.approx(abs(np.sin(x[1])))  # 3-1-3
    assert code.apart(2, pointer) == pytest.approx(abs(np.cos(x[4])))  # 2-3-1


@pytest.mark.parametrize(
    "compiler", [("gcc", "-std=c99", "-Wstrict-prototypes"), ("g++", "-std=c++11", "-x", "c++")]
)
def test_compilers_find_nothing(system: kg.System, tmp_path: Any, compiler: tuple[str, ...]) -> None:
    kg.generate(system, ("mass_matrix",), reanchoring=True).write(tmp_path / "c")
    (tmp_path / "c" / "use.c").write_text('#include "tree_reanchor.h"\n#include "tree.h"\n')
    warnings = [flag for flag in WARNINGS if "prototypes" not in flag]
    subprocess.run([*compiler, *warnings, "-c", "use.c", "-o", "use.o"], cwd=tmp_path / "c", check=True)


def test_what_cannot_be_re_anchored_in_c(system: kg.System) -> None:
    with pytest.raises(
        OptionError, match=r"system 'chain' has nothing to re-anchor in C: no body has three free"
    ):
        kg.generate(systems.chain(2), reanchoring=True)
    with pytest.raises(OptionError, match=r"double precision, not for float in arrays of float"):
        kg.generate(system, ("mass_matrix",), precision="float", reanchoring=True)


def test_other_files_change_where_they_name_the_header(system: kg.System) -> None:
    plain, more = (
        kg.generate(system, ("mass_matrix",), reanchoring=wanted).files for wanted in (False, True)
    )
    changed = {name for name in more if more[name] != plain.get(name)}
    assert changed == {"tree_reanchor.h", "README.md", "CMakeLists.txt"}
    (line,) = set(more["README.md"].splitlines()[1:]) - set(plain["README.md"].splitlines())
    assert line == "| `tree_reanchor.h` | Re-anchors joints at run time |"


def test_from_the_command_line(system: kg.System, tmp_path: Any) -> None:
    system.save(tmp_path / "tree.toml")
    arguments = ("--output", "mass_matrix", "--reanchoring", "-o", str(tmp_path / "c"))
    assert "tree_reanchor.h" in kanegen("generate", str(tmp_path / "tree.toml"), *arguments).stdout
    text = (tmp_path / "c" / "tree_reanchor.h").read_text()
    assert text == kg.generate(system, ("mass_matrix",), reanchoring=True).files["tree_reanchor.h"]
    systems.chain(1).save(tmp_path / "hinge.toml")
    refused = kanegen("generate", str(tmp_path / "hinge.toml"), *arguments, status=2)
    assert "nothing to re-anchor in C" in " ".join(refused.stderr.split())
