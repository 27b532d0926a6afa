"""Floating-point arithmetic of compilers: found out by the self-test, required, and kept off the process."""

import platform
import shlex
import shutil
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import kanegen as kg
from kanegen.artifacts.selftest import selftest_text
from kanegen.errors import BuildError, OptionError
from kanegen.library import load
from kanegen.library.native import cache, compilers, selftest
from kanegen.library.native.build import build
from kanegen.options import TIERS, Variant
from kanegen.program import semantics
from kanegen.program.precision import FLOAT
from tests.support.cases import slow_except
from tests.support.handmade import source
from tests.support.systems import chain

COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)] + [f"{sys.executable} -m ziglang cc"]
EVERYTHING = {*semantics.PROPERTIES, semantics.NARROWING}
TINY = 1e-310
FAST = "-O3 -ffast-math"


def properties(command, flags):
    return selftest.properties(compilers.find(command), tuple(shlex.split(flags)))


@pytest.mark.parametrize("command", COMPILERS)
def test_without_optimisation_everything_is_properties(command):
    assert properties(command, "-O0 -ffp-contract=off") == EVERYTHING


def kept(command, variant):
    """Return the properties that a compiler keeps with the flags that are sound for a variant."""
    found = compilers.find(command)
    return selftest.properties(found, selftest.sound_flags(found, replace(source(), variant=variant)))


@pytest.mark.parametrize("command", slow_except(COMPILERS, *COMPILERS[:2]))
@pytest.mark.parametrize("level", semantics.OPTIMISATIONS)
def test_strict_flags_keep_what_is_promised(command, level):
    assert set(semantics.PROPERTIES) <= kept(command, Variant(optimisation=level, machine="native"))


@pytest.mark.parametrize("command", slow_except(COMPILERS, *COMPILERS[:1]))
@pytest.mark.parametrize("name", semantics.SEMANTICS)
def test_semantics_give_up_no_more_than_they_say(command, name):
    variant = Variant(semantics=name, machine="native", optimisation=3)
    assert set(semantics.guaranteed_properties(variant.semantics)) <= kept(command, variant)


@pytest.mark.parametrize(
    ("flags", "lost"),
    [
        ("-O2 -ffinite-math-only", "not a number"),
        ("-O2 -fassociative-math -fno-signed-zeros -fno-trapping-math", "order of sums"),
        ("-O2 -fno-signed-zeros", "signs of zeros"),
        ("-O2 -mfma -ffp-contract=fast", semantics.OWN_ROUNDING),
        (FAST, "subnormal numbers"),
        (FAST, "rounding of quotients"),
    ],
)
def test_the_program_sees_what_flags_do(flags, lost):
    assert lost not in properties("gcc", flags)


def test_the_remedy_for_dropped_rounding_brings_it_back():
    remedy = selftest.REMEDIES[semantics.NARROWING]
    assert semantics.NARROWING in properties("gcc", shlex.join(("-O2", *remedy)))


FUSING = "-O2 -march=x86-64-v3 -ffp-contract=off"
"""Flags with which gcc 12.1 and 12.2 fuse alternating sums and differences all the same."""


@pytest.mark.skipif(platform.machine() != "x86_64", reason="the instructions are those of x86-64")
def test_the_remedy_for_products_that_are_fused_unasked_keeps_them_apart(tmp_path):
    remedy = selftest.REMEDIES[semantics.OWN_ROUNDING]
    (tmp_path / "selftest.c").write_text(selftest_text())
    command = ["gcc", "-std=c99", *shlex.split(FUSING), *remedy, "-S", "-o", "-", "selftest.c"]
    text = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert "mulpd" in text or "mulsd" in text
    assert "vfm" not in text


@pytest.mark.parametrize("machine", ["auto", "native"])
def test_the_remedy_is_used_where_products_are_fused_unasked(monkeypatch, machine):
    def fusing(compiler, flags):
        is_fused = "-march=native" in flags and "-fno-tree-slp-vectorize" not in flags
        return EVERYTHING - ({semantics.OWN_ROUNDING} if is_fused else set())

    monkeypatch.setattr(selftest, "properties", fusing)
    made = replace(source(), variant=Variant(machine=machine))
    assert selftest.sound_flags(compilers.find(), made)[-1] == "-fno-tree-slp-vectorize"


def test_the_remedy_is_used_where_doubles_become_floats(monkeypatch):
    def forgetful(compiler, flags):
        return EVERYTHING - (set() if "-fno-tree-slp-vectorize" in flags else {semantics.NARROWING})

    monkeypatch.setattr(selftest, "properties", forgetful)
    found = compilers.find()
    assert selftest.sound_flags(found, source(precision=FLOAT))[-1] == "-fno-tree-slp-vectorize"
    assert "-fno-tree-slp-vectorize" not in selftest.sound_flags(found, source())


def test_a_compiler_that_does_not_keep_a_promise_is_refused(monkeypatch):
    monkeypatch.setattr(selftest, "properties", lambda compiler, flags: EVERYTHING - {"not a number"})
    with pytest.raises(BuildError, match=r"does not keep: not a number. Name another compiler, or semantics"):
        kg.build(chain(2))
    kg.build(chain(2), tier=Variant(semantics=("finite",)))


def test_a_program_that_does_not_run(tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "cache"))
    other = tmp_path / "cc"
    other.write_text('#!/bin/sh\n[ "$1" = --version ] || touch selftest\n')
    other.chmod(0o755)
    with pytest.raises(BuildError, match=r"a small test program of .* does not run"):
        build(source(), str(other))


def test_no_library_switches_subnormal_numbers_off(tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "cache"))
    for flags in (FAST, "-Ofast", "-O2 -funsafe-math-optimizations"):
        load(source(), "gcc", flags)
        assert np.float64(TINY) * 1.0 == TINY


def test_loading_what_others_have_linked_is_undone_and_refused(tmp_path, monkeypatch):
    """The library has the code that gcc links for -ffast-math: a constructor that sets two bits of MXCSR."""
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "cache"))
    monkeypatch.setattr(semantics, "linker_flags", tuple)
    constructor = tmp_path / "gcc"
    text = (
        "#include <xmmintrin.h>\n__attribute__((constructor)) static void f(void) { _mm_setcsr(0x9fc0); }\n"
    )
    (tmp_path / "switch.c").write_text(text)
    subprocess.run(["gcc", "-fPIC", "-c", "switch.c", "-o", "switch.o"], cwd=tmp_path, check=True)
    constructor.write_text(
        f'#!/bin/sh\ncase "$*" in *-shared*) exec gcc "$@" {tmp_path}/switch.o ;; esac\nexec gcc "$@"\n'
    )
    constructor.chmod(0o755)
    with pytest.raises(
        BuildError, match=r"loading it changes the floating-point arithmetic of the whole process"
    ):
        load(source(), str(constructor))
    assert np.float64(TINY) * 1.0 == TINY


def test_flags_follow_the_variant():
    assert TIERS["strict"].flags == ("-O2", "-ffp-contract=off")
    assert Variant(semantics=("finite", "contracted"), machine="native", optimisation=3).flags == (
        *("-O3", "-march=native", "-ffp-contract=fast", "-ffinite-math-only"),
    )
    native = Variant(machine="native")
    assert native.flags == ("-O2", "-march=native", "-ffp-contract=off", semantics.UNFUSED)
    assert native.flags_here == Variant().flags_here == ("-O2", "-march=native", "-ffp-contract=off")
    assert Variant(semantics="associative").flags == (
        *("-O2", "-ffp-contract=off", "-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math"),
    )


def test_unknown_choices():
    with pytest.raises(OptionError, match=r"unknown semantics 'fnite'. Did you mean 'finite'"):
        Variant(semantics="fnite")
    with pytest.raises(OptionError, match=r"strict excludes finite. Name one or the other"):
        Variant(semantics=("strict", "finite"))
    with pytest.raises(OptionError, match=r"semantics: expected names, got 3"):
        Variant(semantics=3)
    with pytest.raises(OptionError, match=r"unknown machine 'nativ'. Did you mean 'native'"):
        Variant(machine="nativ")
    with pytest.raises(OptionError, match=r"unknown optimisation 4. Known are '0', '1', '2', '3'"):
        Variant(optimisation=4)
    with pytest.raises(OptionError, match=r"unknown tier 'fastest'. Did you mean 'fast'"):
        kg.generate(chain(2), tier="fastest")


def test_the_header_says_what_was_chosen():
    text = kg.generate(chain(2), tier="fast").files["chain.h"]
    assert " *     semantics: contracted, reciprocal, no-signed-zeros, no-traps, no-errno\n" in text
    assert " *     machine: native\n" in text
