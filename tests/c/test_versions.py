"""Functions in versions for several instruction sets: their bits, the choice among them, and compilers."""

from __future__ import annotations

import platform
import re
from dataclasses import replace
from functools import cache
from pathlib import Path, PurePosixPath

import numpy as np
import pytest

import kanegen as kg
from kanegen.c.c99 import C99
from kanegen.c.versions import VERSIONS, Dispatched, defined_names, macros_of_width
from kanegen.errors import OptionError
from kanegen.library import load
from kanegen.library.native import compilers, selftest
from kanegen.library.native.build import code, write
from kanegen.program import semantics
from tests.battery import bits, scenes, targets
from tests.battery.state_classes import states
from tests.support import systems
from tests.support.c_compilers import WARNINGS, C, run
from tests.support.cases import slow_except
from tests.support.paths import MODELS

TIER = kg.Variant(machine="multiversioned")
ARM = scenes.planar([1.0] * 6)
"""Six hinges, whose sines one state computes in vectors."""

ON_X86_64 = pytest.mark.skipif(platform.machine() != "x86_64", reason="the versions are those of x86-64")


@cache
def expected(system, precision):
    """Return states of eight classes, and the bits of portable code in them."""
    portable = kg.generate(system, bits.OUTPUTS, precision=precision)
    state = states(system, bits.storage(portable), 3, 40, targets.classes(portable.variant))
    return state, bits.printed(portable, state, "gcc", "-O1")


def same_bits(system, compiler, flags, precision="double"):
    state, found = expected(system, precision)
    tier = kg.Variant(precision=precision, machine="multiversioned")
    versions = kg.generate(system, bits.OUTPUTS, tier=tier)
    assert bits.printed(versions, state, " ".join(C[compiler]), flags) == found


@pytest.mark.parametrize(
    ("compiler", "widest"), [("gcc", 512), pytest.param("clang", 256, marks=pytest.mark.slow)]
)
def test_a_version_has_the_bits_of_portable_code(compiler, widest):
    """Also where the compiler may fuse products and sums, as gcc may by default: the code forbids it."""
    fusing = "-ffp-contract=fast" if compiler == "gcc" else "-ffp-contract=on"
    same_bits(ARM, compiler, f"-O2 {fusing} -DKANEGEN_WIDEST={widest}")


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["double", "float"])
@pytest.mark.parametrize("compiler", C)
@pytest.mark.parametrize("level", ["-O0", "-O3"])
@pytest.mark.parametrize("system", [targets.system(), systems.chain(6)], ids=["tree", "chain"])
@pytest.mark.parametrize("widest", [one.bits for one in VERSIONS])
def test_all_versions_at_all_levels_have_the_bits_of_portable_code(
    system, precision, compiler, level, widest
):
    same_bits(system, compiler, f"{level} -DKANEGEN_WIDEST={widest}", precision)


@pytest.fixture(scope="module")
def top(tmp_path_factory):
    """Return a folder with the versions of a top: parameters, loads, rollouts, derivatives of steps."""
    folder = tmp_path_factory.mktemp("versions")
    joint = kg.Joint(free=(True, True, True, False, False, True))
    body = kg.Body("link", 0, kg.Parameter("m", 2.0), np.eye(3), (0.5, 0, 0), joint, loads=True)
    outputs = (*bits.OUTPUTS, "rollout_rk4", "step_rk4_derivatives")
    write(code(kg.generate(kg.System("top", (body,)), outputs, tier=TIER)), folder)
    return folder


def compiled(folder, compiler, *flags):
    """Compile all files with all warnings as errors, and return the names of the functions in them."""
    for file in ("top.c", "top_batch.c"):
        command = [*C[compiler], "-std=c99", *WARNINGS, *flags, "-c", file, "-o", f"{file}.o"]
        run(*command, folder=folder)
    text = run("nm", "top.c.o", "top_batch.c.o", folder=folder)
    return set(re.findall(r" [tT] (\w+)", text))


@ON_X86_64
@pytest.mark.parametrize("compiler", C)
def test_parts_that_are_joined_and_matrices_that_hold_values_once(compiler):
    system = systems.random_system(np.random.default_rng(3), 6, connection=(0, 1, 1, 0, 4, 4), name="forked")
    x = np.random.default_rng(4).uniform(-1.0, 1.0, (19, len(system.coordinates)))
    portable, versions = (
        kg.generate(system, ("mass_matrix",), target=C99(longest_part=500), tier=tier)
        for tier in ("strict", TIER)
    )
    assert "SIMD_PART" in versions.files["forked_batch_version.h"]
    assert "A_places" in versions.files["forked_batch_version.h"]
    expected = load(portable, flags=("-O1", "-ffp-contract=off")).mass_matrix(x)
    found = load(versions, " ".join(C[compiler]), ("-O1",)).mass_matrix(x)
    assert found.tobytes() == expected.tobytes()


BOTH = {"top_evaluate", "top_rollout_rk4", "top_evaluate_batch", "top_rollout_rk4_batch"}


@ON_X86_64
@pytest.mark.parametrize(("compiler", "flags"), [("gcc", ["-fopenmp"]), ("clang", [])])
def test_every_function_has_a_version_for_each_instruction_set(top, compiler, flags):
    found = compiled(top, compiler, *flags)
    assert BOTH | {f"{name}_{one.bits}" for name in BOTH for one in VERSIONS} <= found


@ON_X86_64
@pytest.mark.parametrize(
    ("compiler", "flag"), [("gcc", "-mavx2"), ("gcc", "-DKANEGEN_LANES=4"), ("clang", "-fopenmp")]
)
def test_there_is_one_version_where_there_can_be_no_other(top, compiler, flag):
    found = compiled(top, compiler, flag)
    assert found >= BOTH
    assert not [name for name in found if name.endswith(tuple(f"_{one.bits}" for one in VERSIONS))]


CHOICE = """
#include <stdio.h>
#include "top.c"
int main(void) { return printf("%d", kanegen_bits()) < 0; }
"""


def supported():
    """Return the bits of the widest vectors that Linux says this machine has."""
    text = re.search(r"^flags\s*:(.*)$", Path("/proc/cpuinfo").read_text(), flags=re.MULTILINE)
    flags = set(text[1].split())
    return max(one.bits for one in VERSIONS if flags.issuperset(one.features))


@ON_X86_64
@pytest.mark.parametrize(("compiler", "widest"), [("gcc", 512), ("clang", 512), ("gcc", 256)])
def test_a_program_runs_the_widest_version_that_it_can(top, compiler, widest):
    (top / "choice.c").write_text(CHOICE)
    run(*C[compiler], f"-DKANEGEN_WIDEST={widest}", "choice.c", "-lm", "-o", "choice", folder=top)
    assert int(run("./choice", folder=top)) == min(supported(), widest)


RACE = """
#include <pthread.h>
#include <stdio.h>
#include "top.h"

static void *called(void *result)
{
    const double m[1] = {2.0}, x[4] = {0.1, 0.2, 0.3, 0.4};
    double prepared[TOP_PREPARED], A[16];
    (void)top_prepare(m, prepared);
    *(int *)result = top_mass_matrix(prepared, x, A) || (int)top_mass_matrix_batch(1, prepared, x, A);
    return NULL;
}

int main(void)
{
    pthread_t thread[8];
    int result[8], failed = 0;
    for (int i = 0; i < 8; ++i) failed |= pthread_create(&thread[i], NULL, called, &result[i]);
    for (int i = 0; i < 8; ++i) failed |= pthread_join(thread[i], NULL) || result[i];
    return failed;
}
"""


def test_the_first_calls_of_several_threads_do_not_race(top):
    (top / "race.c").write_text(RACE)
    flags = ["-std=c99", "-fsanitize=thread", "-g"]
    run("gcc", *flags, "race.c", "top.c", "top_batch.c", "-lm", "-pthread", "-o", "race", folder=top)
    run("./race", folder=top, TSAN_OPTIONS="halt_on_error=1")


def test_common_headers_are_those_of_portable_code():
    """Models of both kinds can stand in one folder."""
    portable, versions = kg.generate(ARM), kg.generate(ARM, tier=TIER)
    common = {name for name in portable.files if name.startswith("kanegen_")}
    assert common and all(portable.files[name] == versions.files[name] for name in common)
    assert "instruction sets of x86-64" in versions.files[f"{ARM.name}.h"]
    assert "instruction set" not in portable.files[f"{ARM.name}.h"] + portable.files["README.md"]


@pytest.mark.parametrize("artifact", slow_except(["fmi2", "fmi3", "rust", "arduino"], "fmi3"))
def test_folders_of_artifacts_hold_the_functions(artifact):
    files = kg.generate(ARM, tier=TIER, artifacts=artifact).files
    (path,) = [PurePosixPath(name) for name in files if name.endswith(f"/{ARM.name}.c")]
    assert f'#define KANEGEN_VERSION_FILE "{ARM.name}_version.h"' in files[str(path)]
    assert {
        str(path.with_name(name)) for name in (f"{ARM.name}_version.h", "kanegen_versions.h")
    } <= files.keys()


@pytest.mark.parametrize(("storage", "is_narrowed"), [("float", True), ("double", False)])
def test_the_self_test_of_rounding_to_float_is_wanted_for_versions_too(storage, is_narrowed, monkeypatch):
    everything = {*semantics.PROPERTIES, semantics.NARROWING}
    remedy = selftest.REMEDIES[semantics.NARROWING]

    def forgetful(compiler, flags):
        return everything - (set() if remedy[0] in flags else {semantics.NARROWING})

    monkeypatch.setattr(selftest, "properties", forgetful)
    source = kg.generate(ARM, tier=replace(TIER, storage=storage))
    assert (remedy[0] in selftest.sound_flags(compilers.find(), source)) is is_narrowed


FUSED = re.compile(r"\bvfn?m(add|sub)")
"""Fused multiply-adds, as compilers for x86-64 write them."""


@ON_X86_64
@pytest.mark.slow
@pytest.mark.parametrize("machine", ["native", "multiversioned"])
@pytest.mark.parametrize("compiler", C)
@pytest.mark.parametrize("level", ["-O2", "-O3"])
@pytest.mark.parametrize("march", ["x86-64-v3", "x86-64-v4"])
def test_no_product_is_fused_with_a_sum_in_native_code(machine, compiler, level, march, tmp_path):
    """Native code has flags for that; versions, compiled by users with -march=native, forbid it."""
    outputs = ("forward_dynamics", "forward_dynamics_derivatives")
    source = kg.generate(kg.load(MODELS / "free_body.toml"), outputs, tier=kg.Variant(machine=machine))
    write(code(source), tmp_path)
    own = [flag for flag in source.variant.flags if flag.startswith("-f")]
    forbidden = own if machine == "native" else []
    for file in ("free_body.c", "free_body_batch.c"):
        flags = ["-std=c99", *WARNINGS, level, f"-march={march}", *forbidden, "-S", "-o", "-"]
        text = run(*C[compiler], *flags, file, folder=tmp_path)
        assert "vmulsd" in text and not FUSED.search(text)


def test_a_library_of_versions_computes_the_bits_of_a_native_one():
    native, versions = kg.build(ARM), kg.build(ARM, tier=TIER)
    x = np.random.default_rng(5).normal(size=(9, 6))
    assert "-march=native" not in versions.source.variant.flags_here
    for one in (x, x[0]):
        assert native.mass_matrix(one).tobytes() == versions.mass_matrix(one).tobytes()


def test_what_versions_need():
    with pytest.raises(
        OptionError, match=r"'multiversioned' needs strict semantics: with finite the results "
    ):
        kg.Variant(machine="multiversioned", semantics="finite")
    with pytest.raises(OptionError, match=r"'multiversioned' does not go with precision 'double-double'"):
        kg.Variant(machine="multiversioned", precision="double-double")


TEXT = """
#define KANEGEN_OTHER_H
#define SIMD_EVEN_2 0, 1
#define INFINITY_CARRY 1ULL
typedef double simd __attribute__((vector_size(8 * KANEGEN_LANES)));
typedef union {
    simd numbers;
} simd_view;
static inline simd simd_of(double number)
{
    return other(number);
}
static NOINLINE void arm_forcing_1(const double *x,
    double *f)
{
}
static const double *pointer(int arm_other(int), size_t count)
{
}
"""


def test_what_a_version_has_for_itself():
    names = ["simd", "simd_view", "simd_of", "arm_forcing_1", "pointer"]
    assert defined_names([TEXT, TEXT]) == names
    assert macros_of_width([TEXT]) == ["KANEGEN_OTHER_H", "SIMD_EVEN_2"]
    prototype = ["int arm_f(const double x[2 * 3], size_t x_rows, const double *y,", "    double f[2])"]
    assert Dispatched.of("arm_f", prototype).call == ["    return KANEGEN_CHOSEN(arm_f)(x, x_rows, y, f);"]
