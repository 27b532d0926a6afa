"""What C and C++ compilers, sanitizers, CMake and pkg-config say about the generated files."""

import re
import shutil
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import kanegen as kg
from kanegen.recursion.outputs import DERIVATIVES, available
from tests.support.c_compilers import CPP, SANITIZERS, WARNINGS, C, code, printed, run
from tests.support.cases import slow_among, slow_except
from tests.support.handmade import bits, evaluate, module, source
from tests.support.paths import GENERATED, MODELS

GENERATED_FOLDERS = sorted(GENERATED.iterdir())
WARNING_LEVELS = {"gcc": "-O1", "clang": "-O0"}
"""The least optimisation at which a compiler gives all its warnings: gcc has to follow values for some."""
VARIANTS = {
    "all": {},
    "plain": {"parameters": False, "loads": False},
    "mass_matrix": {"outputs": ("mass_matrix",), "loads": False},
    "forcing": {"outputs": ("forcing",), "parameters": False},
}


@pytest.fixture(params=VARIANTS)
def variant(request):
    return VARIANTS[request.param]


@pytest.mark.parametrize("compiler", C)
@pytest.mark.parametrize(
    "folder",
    slow_among(GENERATED_FOLDERS, GENERATED / "eight_body", GENERATED / "front_of_eight"),
    ids=lambda path: path.name,
)
def test_the_c_of_every_model_is_clean(compiler, folder, tmp_path):
    for file in (f"{folder.name}.c", f"{folder.name}_batch.c", "main.c"):
        command = (*C[compiler], "-std=c99", WARNING_LEVELS[compiler], *WARNINGS, "-c", file)
        run(*command, "-o", tmp_path / "object.o", folder=folder)


@pytest.mark.parametrize("compiler", C)
def test_a_function_in_parts_is_clean_where_no_part_reads_an_input(compiler, tmp_path):
    """The mass matrix does not read the one run-time parameter, gravity."""
    whole = kg.load(MODELS / "eight_body.toml")
    system = replace(whole, gravity=(0.0, 0.0, kg.Parameter("g", -9.81)))
    folder = _generated(system, ("mass_matrix", "forcing"), "double").write(tmp_path / "out")
    for file in ("eight_body.c", "eight_body_batch.c"):
        run(
            *C[compiler], "-std=c99", "-O0", *WARNINGS, "-c", file, "-o", tmp_path / "object.o", folder=folder
        )


@cache
def _generated(system, outputs, precision):
    return kg.generate(system, outputs, precision=precision)


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["float", "double"])
@pytest.mark.parametrize("compiler", C)
def test_long_functions_of_every_output_are_clean(precision, compiler, tmp_path):
    outputs = [name for name in available(kg.load(MODELS / "eight_body.toml")) if name not in DERIVATIVES]
    _check_long_functions(tuple(outputs), precision, compiler, tmp_path)


def test_long_functions_in_parts_are_clean(tmp_path):
    _check_long_functions(("forward_dynamics", "mass_matrix"), "float", "gcc", tmp_path)


def _check_long_functions(outputs, precision, compiler, tmp_path):
    system = kg.load(MODELS / "eight_body.toml")
    folder = _generated(system, outputs, precision).write(tmp_path / "out")
    for file in ("eight_body.c", "eight_body_batch.c"):
        assert "eight_body_evaluate" in (folder / file).read_text()
        assert re.search(r"(NOINLINE|SIMD_PART) (int|simd_bits) ", (folder / file).read_text())
        run(*C[compiler], "-std=c99", "-O0", *WARNINGS, "-c", file, folder=folder)


@pytest.mark.slow
def test_the_example_of_eight_body_runs_under_sanitizers(tmp_path):
    folder = GENERATED_FOLDERS[[path.name for path in GENERATED_FOLDERS].index("eight_body")]
    example = tmp_path / "example"
    run(*C["gcc"], "-std=c99", *SANITIZERS, "main.c", *code("eight_body"), "-o", example, folder=folder)
    assert run(example, folder=folder, ASAN_OPTIONS="detect_leaks=0").count(" = ") == 2 * (48 * 48 + 48)


@pytest.mark.parametrize("compiler", C)
def test_c_is_clean_and_needs_only_libm(compiler, variant, tmp_path):
    folder = source(**variant).write(tmp_path / "out")
    for file in ("handmade.c", "handmade_batch.c", "main.c"):
        run(*C[compiler], "-std=c99", "-O2", *WARNINGS, "-c", file, folder=folder)
    for file in ("handmade.o", "handmade_batch.o"):
        undefined = {line.split()[-1] for line in run("nm", "-u", file, folder=folder).splitlines()}
        assert undefined <= {"sqrt"}
        symbols = run("nm", "--defined-only", file, folder=folder).splitlines()
        assert {line.split()[1] for line in symbols} <= {"T", "t", "r"}  # code and constants, no data
        assert all(line.split()[2].startswith("handmade_") for line in symbols if " T " in line)


@pytest.mark.parametrize("compiler", CPP)
@pytest.mark.parametrize("standard", slow_except(("c++98", "c++17"), "c++98"))
def test_the_header_is_cpp(compiler, standard, variant, tmp_path):
    folder = source(**variant).write(tmp_path / "out")
    (tmp_path / "user.cpp").write_text(
        '#include "out/handmade.h"\nint main() { return HANDMADE_BODIES - 3; }\n'
    )
    flags = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    run(*CPP[compiler], f"-std={standard}", *flags, "user.cpp", "-o", "user", folder=folder.parent)
    run("./user", folder=folder.parent)


def test_the_example_runs_under_sanitizers_and_prints_the_right_numbers(variant, tmp_path):
    folder = source(**variant, sincos="libm").write(tmp_path / "out")
    run(
        *C["gcc"],
        "-std=c99",
        "-O1",
        *SANITIZERS,
        "main.c",
        *code("handmade"),
        "-o",
        "example",
        folder=folder,
    )
    results = printed(run("./example", folder=folder, ASAN_OPTIONS="detect_leaks=0"))

    made = module(**variant)
    inputs = {"x": [0.1, 0.2], "y": [0.1, 0.2], "parameters": [2.0, 0.75]}
    inputs["force"] = inputs["torque"] = [(1 + i % 7) / 10 for i in range(9)]
    expected = {}
    if made.prepare:
        inputs |= evaluate(made.prepare, **inputs)
        expected["prepare", "prepared"] = inputs["prepared"]
    for name, program in made.functions.items():
        expected |= {(name, array): values for array, values in evaluate(program, **inputs).items()}
    assert results.keys() == expected.keys()
    for key, values in expected.items():
        assert bits(results[key]) == bits(values), key


def test_batches_under_sanitizers(tmp_path):
    folder = source(parameters=False).write(tmp_path / "out")
    x = np.linspace(-1, 1, 10)
    numbers = ", ".join(map(repr, x.tolist()))
    (folder / "many.c").write_text(
        '#include <stdio.h>\n#include <stdlib.h>\n#include "handmade.h"\n'
        "int main(void) {\n"
        f"    const double x[10] = {{{numbers}}};\n"
        "    double *A = malloc(5 * 4 * sizeof *A);\n"
        "    handmade_mass_matrix_batch(0, NULL, NULL);\n"
        "    handmade_mass_matrix_batch(5, x, A);\n"
        '    for (int i = 0; i < 20; ++i) printf("%.17g\\n", A[i]);\n'
        "    free(A);\n    return 0;\n}\n"
    )
    run(*C["gcc"], "-std=c99", *SANITIZERS, "many.c", *code("handmade"), "-o", "many", folder=folder)
    result = [float(line) for line in run("./many", folder=folder).split()]
    program = module(parameters=False).functions["mass_matrix"]
    expected = [evaluate(program, x=row)["A"] for row in x.reshape(5, 2)]
    np.testing.assert_allclose(result, np.ravel(expected), rtol=0, atol=1e-15)


def test_cmake_and_pkg_config_find_the_installed_library(tmp_path):
    folder = source().write(tmp_path / "out")
    installed = tmp_path / "installed"
    run("cmake", "-S", ".", "-B", "../build", f"-DCMAKE_INSTALL_PREFIX={installed}", folder=folder)
    run("cmake", "--build", "../build", folder=folder)
    run("cmake", "--build", "../build", "--target", "kanegen_handmade_example", folder=folder)
    run("cmake", "--install", "../build", folder=folder)

    user = tmp_path / "user"
    user.mkdir()
    shutil.copy(folder / "main.c", user)
    (user / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.14)\nproject(user C)\nfind_package(handmade 0.1 REQUIRED)\n"
        "add_executable(user main.c)\ntarget_link_libraries(user handmade::handmade)\n"
    )
    run("cmake", "-S", ".", "-B", "build", f"-DCMAKE_PREFIX_PATH={installed}", folder=user)
    run("cmake", "--build", "build", folder=user)
    by_cmake = run("build/user", folder=user)

    (metadata,) = installed.rglob("handmade.pc")
    path = str(metadata.parent)
    flags = run("pkg-config", "--cflags", "--libs", "handmade", folder=user, PKG_CONFIG_PATH=path).split()
    run(*C["gcc"], "main.c", *flags, "-o", "by_pkg_config", folder=user)
    assert (
        run("./by_pkg_config", folder=user)
        == by_cmake
        == run("../build/kanegen_handmade_example", folder=folder)
    )
    assert by_cmake.count(" = ") == 2 + 4 + 2 + 6
