"""The C in single precision: its text, what compilers and sanitizers say of it, and how it is used."""

import re

import numpy as np
import pytest

import kanegen as kg
from kanegen.artifacts import with_artifacts
from kanegen.c import render
from kanegen.errors import WriteError
from kanegen.library import load
from kanegen.library.native import cache
from kanegen.options import TIERS
from kanegen.program.ir import Module
from kanegen.program.precision import DOUBLE, FLOAT
from tests.support.c_compilers import CPP, SANITIZERS, WARNINGS, C, code, printed, run
from tests.support.cases import slow_except
from tests.support.command import kanegen
from tests.support.handmade import bits, description, evaluate, module, source
from tests.support.paths import PENDULUM
from tests.support.pivot_programs import forward, inverse
from tests.support.simd import FLAGS, wide
from tests.support.systems import random_system

ALL = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")


def test_the_c_has_doubles_only_where_parameters_are_prepared():
    files = source(precision=FLOAT).files
    prepare, rest = files["handmade.c"].split("int handmade_mass_matrix")
    assert "const double p_m1 = (double)parameters[HANDMADE_P_m1];" in prepare
    assert "prepared[HANDMADE_C_c_1] = (float)" in prepare
    assert "sqrtf(" in rest
    assert "3.0f" in rest
    code = rest + files["handmade_batch.c"] + files["kanegen_simdf.h"] + files["kanegen_sincosf.h"]
    assert "double" not in code
    assert "type float" in files["handmade.h"]
    assert "in single precision" in files["handmade.pc.in"]
    assert not re.search(r"kanegen_(simd|sincos)\.h", "".join(files.values()))
    first_lines = [
        {text.partition("\n")[0] for text in source(precision=p).files.values()} for p in (DOUBLE, FLOAT)
    ]
    assert not first_lines[0] & first_lines[1]


@pytest.mark.parametrize("compiler", C)
@pytest.mark.parametrize("width", slow_except(("", "-DKANEGEN_LANES=1", "-DKANEGEN_LANES=16"), ""))
def test_c_is_clean_and_needs_only_libm(compiler, width, tmp_path):
    """No number becomes a double, in programs made by hand and in a tree with every output."""
    status = {"forward_dynamics": forward(), "inverse_dynamics": inverse()}
    tree = random_system(np.random.default_rng(4), 2, loads=True)
    sources = [
        source(precision=FLOAT),
        with_artifacts(
            render(description(parameters=False, loads=False), Module(None, status), {}, TIERS["single"])
        ),
        *([] if width else [kg.generate(tree, ALL, precision="float")]),
    ]
    for number, made in enumerate(sources):
        name = made.model.name
        folder = made.write(tmp_path / str(number))
        flags = ["-std=c99", "-O1", *WARNINGS, *width.split()]
        for file in (f"{name}.c", f"{name}_batch.c", "main.c"):
            run(*C[compiler], *flags, "-c", file, folder=folder)
        undefined = {
            line.split()[-1] for line in run("nm", "-u", f"{name}_batch.o", folder=folder).splitlines()
        }
        assert undefined <= {"sqrtf", "memcpy"}


@pytest.mark.parametrize("compiler", CPP)
def test_the_header_is_cpp(compiler, tmp_path):
    folder = source(precision=FLOAT).write(tmp_path / "out")
    (folder / "user.cpp").write_text('#include "handmade.h"\nint main() { return HANDMADE_BODIES - 3; }\n')
    run(
        *CPP[compiler],
        "-std=c++98",
        "-Wall",
        "-Wextra",
        "-Wpedantic",
        "-Werror",
        "-c",
        "user.cpp",
        folder=folder,
    )


def test_the_example_by_cmake_and_under_sanitizers(tmp_path):
    folder = source(precision=FLOAT).write(tmp_path / "out")
    sanitized = ["-std=c99", "-O1", *SANITIZERS, "main.c", *code("handmade"), "-o", "example"]
    run(*C["gcc"], *sanitized, folder=folder)
    text = run("./example", folder=folder, ASAN_OPTIONS="detect_leaks=0")
    run("cmake", "-S", ".", "-B", "build", folder=folder)
    run("cmake", "--build", "build", "--target", "kanegen_handmade_example", folder=folder)
    assert run("build/kanegen_handmade_example", folder=folder) == text

    inputs = {"x": [0.1, 0.2], "y": [0.1, 0.2]}
    inputs["force"] = inputs["torque"] = [(1 + i % 7) / 10 for i in range(9)]
    inputs |= evaluate(module().prepare, parameters=[2.0, 0.75])
    results = printed(text)
    assert bits(results["prepare", "prepared"]) == bits(inputs["prepared"])
    for name, program in module().functions.items():
        for array, values in evaluate(program, np.float32, **inputs).items():
            np.testing.assert_allclose(results[name, array], values, rtol=3e-7, err_msg=array)


@pytest.mark.parametrize("compiler", C.values(), ids=C)
@pytest.mark.parametrize(
    "flags",
    [pytest.param(FLAGS, marks=pytest.mark.slow), ("-O3", "-ffp-contract=off", "-march=native")],
    ids=["O1", "O3"],
)
def test_every_width_and_compiler_gives_the_same_bits(compiler, flags, tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path))
    x, y = np.random.default_rng(11).normal(size=(2, 37, 2)).astype(np.float32) * 3
    made = source(loads=False, precision=FLOAT)
    expected = load(made, flags=wide(1)).evaluate(x, y)
    for width in (1, 2, 4, 8, 16):
        found = load(made, " ".join(compiler), wide(width, *flags)).evaluate(x, y)
        assert bits(found.mass_matrix) == bits(expected.mass_matrix), width
        assert bits(found.forcing) == bits(expected.forcing), width


def test_files_of_one_precision_replace_those_of_the_other_unless_they_were_changed(tmp_path):
    folder = source().write(tmp_path / "out")
    source(precision=FLOAT).write(folder)
    assert "type float" in (folder / "handmade.h").read_text()
    assert (folder / "kanegen_simdf.h").is_file()
    with (folder / "kanegen_simd.h").open("a") as file:
        file.write("int mine;\n")
    with pytest.raises(WriteError, match=r"holds kanegen_simd\.h, which are not this model's files"):
        source(precision=FLOAT).write(folder)


def test_the_command_line(tmp_path):
    kanegen("generate", PENDULUM, "-o", str(tmp_path / "out"), "--precision", "float")
    assert "float x[2]" in (tmp_path / "out" / "double_pendulum.h").read_text()
    assert "2^-24" in kanegen("check", PENDULUM, "--states", "20", "--precision", "float").stdout
    error = kanegen("check", PENDULUM, "--precision", "quad", status=2).stderr
    known = "'double', 'float', 'long double', 'double-double'"
    assert error == f"error: unknown precision 'quad'. Known are {known}.\n"
