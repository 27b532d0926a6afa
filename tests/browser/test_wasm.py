"""WebAssembly of generated C beside the native library: the same bits; and what is refused."""

import math
import shlex
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import wasmtime

import kanegen as kg
from kanegen.browser import toolchain
from kanegen.browser.wasm import exports, library_files, wasm_module
from kanegen.errors import BuildError, OptionError
from kanegen.library import load
from kanegen.library.native import commands
from kanegen.library.native.build import write
from kanegen.options import TIERS
from kanegen.program.precision import precision_named
from tests.support.paths import ROOT
from tests.support.random_trees import everything
from tests.support.wasm import WasmLibrary, bits, inputs_of, native_results

STATES = 1000
OUTPUTS = ("forward_dynamics", "kinetic_energy", "body_poses")


def model(name):
    return kg.load(ROOT / "models" / f"{name}.toml")


def compare(system, variant=TIERS["strict"], count=STATES, outputs=OUTPUTS, **options):
    """Compare functions of one state in WebAssembly, state by state, with native ones."""
    source = kg.generate(system, outputs, tier=variant)
    native, wasm = load(source, on_status="ignore"), WasmLibrary(source, **options)
    constants = {"prepared": prepared(wasm, system)} if system.parameters else {}
    dtype = precision_named(source.storage).dtype
    for function in source.functions:
        if function.name in outputs:
            inputs = inputs_of(system, function, dtype, count)
            names = [array.name for array in function.inputs]
            rows = (
                {**constants, **dict(zip(inputs, row, strict=True))}
                for row in zip(*inputs.values(), strict=True)
            )
            found = [wasm(function.name, *(row[name] for name in names))[0] for row in rows]
            expected = native_results(native, function, inputs)
            assert np.array_equal(bits(np.array(found)), bits(expected)), function.name
    return wasm


def prepared(wasm, system):
    return wasm("prepare", [parameter.value for parameter in system.parameters])[0]


SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("eight_body", "panda_arm", "quarter_car")]


@pytest.mark.parametrize("name", ["double_pendulum", "satellite", *SLOW])
def test_strict_doubles_have_the_bits_of_native_code(name):
    system = model(name)
    compare(system)


def test_vectors_change_no_bit():
    wasm = compare(model("scara"), count=200, simd=True)
    assert b"\xfd" in wasm_module(wasm.source, simd=True)  # the prefix of the instructions of vectors


def test_floats_have_the_bits_of_native_code():
    system = model("double_pendulum")
    compare(system, TIERS["single"])


def test_coarse_sines_have_the_bits_of_native_code():
    system = model("furuta_pendulum")
    compare(system, kg.Variant(sincos="polynomial-5"))


def test_double_double_has_the_bits_of_native_code():
    system = model("double_pendulum")
    compare(system, TIERS["exact"], 200)


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (0, 2, 3))])
def test_random_trees_with_all_inputs_have_the_bits_of_native_code(seed):
    compare(everything(seed, bodies=3), count=40)


@pytest.mark.parametrize("simd", [False, True])
def test_batches_have_the_bits_of_native_code(simd):
    system = model("double_pendulum")
    source = kg.generate(system, ("forward_dynamics",))
    wasm, native = WasmLibrary(source, batch=True, simd=simd), load(source)
    function = next(one for one in source.functions if one.name == "forward_dynamics")
    inputs = inputs_of(system, function, np.float64, 33)
    found, status = wasm.batch("forward_dynamics", prepared(wasm, system), *inputs.values())
    assert status == 0
    assert np.array_equal(bits(found), bits(native.forward_dynamics(**inputs)))


def test_statuses_are_those_of_native_code():
    source = kg.generate(model("double_pendulum"), ("forward_dynamics",))
    wasm = WasmLibrary(source)
    prepared, status = wasm("prepare", [9.81, 1.0, 1.0, 0.0, 0.7])
    assert status == 3  # an inertia of 0 is divided by
    ydot, status = wasm("forward_dynamics", prepared, [0.1, 0.2], [0.0, 0.0], [0.0, 0.0])
    assert status == 2
    assert np.isnan(ydot).all()


@pytest.mark.parametrize("command", [f"{shlex.quote(sys.executable)} -m ziglang cc", "clang"])
def test_both_toolchains_give_the_bits_of_native_code(monkeypatch, command):
    if command == "clang":
        monkeypatch.setenv(toolchain.VARIABLE, command)
    else:
        monkeypatch.setattr(toolchain, "shutil", SimpleNamespace(which=lambda name: None))
    assert (toolchain.find().option == "-Wl,") == (command == "clang")
    compare(model("furuta_pendulum"), count=50)


def test_modules_are_the_same_bytes_again_and_are_cached(tmp_path, monkeypatch):
    source = kg.generate(model("planar_pendulum"), ("forward_dynamics",))
    first = wasm_module(source)
    monkeypatch.setenv("KANEGEN_CACHE", str(tmp_path))
    assert wasm_module(source) == first
    monkeypatch.setattr(commands, "make_all", None)
    assert wasm_module(source) == first


def test_exports_are_the_functions_of_the_header():
    source = kg.generate(model("planar_pendulum"), ("forward_dynamics",))
    wasm = WasmLibrary(source, batch=True)
    assert set(exports(source, batch=True)) < set(wasm.exports.keys())
    assert {"memory", "__heap_base"} < set(wasm.exports.keys())


@pytest.mark.parametrize(
    ("variant", "mends"),
    [
        (kg.Variant(precision="long double"), "Take precision double-double"),
        (kg.Variant(sincos="libm"), "Take sincos shared"),
        (kg.Variant(semantics=("flush-to-zero",)), "Take strict semantics"),
    ],
)
def test_what_webassembly_does_not_have_is_refused(variant, mends):
    source = kg.generate(model("planar_pendulum"), ("forward_dynamics",), tier=variant)
    with pytest.raises(OptionError, match=mends):
        wasm_module(source)


def test_without_a_compiler_one_line_says_how_to_get_one(monkeypatch):
    monkeypatch.delenv(toolchain.VARIABLE, raising=False)
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(toolchain, "is_installed", lambda package: False)
    with pytest.raises(BuildError, match=r"pip install ziglang") as caught:
        toolchain.find()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("command", ["gcc", "no-such-compiler", "'"])
def test_a_named_compiler_that_makes_no_webassembly_is_refused(monkeypatch, command):
    monkeypatch.setenv(toolchain.VARIABLE, command)
    with pytest.raises(BuildError, match=toolchain.VARIABLE) as caught:
        toolchain.find()
    assert "\n" not in str(caught.value)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("tier", ["exact", "single"])
def test_random_trees_in_other_precisions_have_the_bits_of_native_code(tier, seed):
    compare(everything(seed, bodies=2), TIERS[tier], count=20, outputs=("forward_dynamics",))


@pytest.fixture(scope="module")
def mathematics(tmp_path_factory):
    """The functions that stand for those of a C library, in WebAssembly."""
    folder, found = tmp_path_factory.mktemp("mathematics"), toolchain.find()
    write({**library_files(), "probe.c": PROBE}, folder)
    names = ("sin", "cos", "ldexp", "frexp")
    flags = "-std=c99 -O2 -ffp-contract=off -fno-builtin -isystem include -c".split()
    files = {"probe.o": "probe.c", "mathematics.o": "runtime/mathematics.c", "memory.o": "runtime/memory.c"}
    commands.make_all(
        {made: [*found.compile, *flags, file, "-o", made] for made, file in files.items()}, folder
    )
    options = found.linker_options(("--no-entry", *(f"--export=my_{name}" for name in names)))
    commands.make([*found.link, "-o", "probe.wasm", *files, *options], "probe.wasm", folder)
    store = wasmtime.Store()
    module = wasmtime.Module(store.engine, (folder / "probe.wasm").read_bytes())
    exports_ = wasmtime.Instance(store, module, []).exports(store)
    return lambda name, *arguments: exports_[f"my_{name}"](store, *arguments)


PROBE = """
#include <math.h>
double my_sin(double x);
double my_cos(double x);
double my_ldexp(double x, int n);
double my_frexp(double x, int whole);
double my_sin(double x) { return sin(x); }
double my_cos(double x) { return cos(x); }
double my_ldexp(double x, int n) { return ldexp(x, n); }
double my_frexp(double x, int whole) { int k; const double m = frexp(x, &k); return whole ? k : m; }
"""

SUBNORMAL = 5e-324

NUMBERS = (0.0, -0.0, 1.0, -0.75, 1.5e300, 2.5e-308, SUBNORMAL, -3 * SUBNORMAL, 1 + 2**-52)


@pytest.mark.parametrize("number", NUMBERS)
def test_powers_of_two_are_those_of_python(mathematics, number):
    significand, exponent = math.frexp(number)
    assert math.copysign(1, mathematics("frexp", number, 0)) == math.copysign(1, number)
    assert (mathematics("frexp", number, 0), mathematics("frexp", number, 1)) == (significand, exponent)
    for power in (*range(-1080, 1080, 27), -3000, -2200, -2099, 2047, 2100, 3000):
        try:
            expected = math.ldexp(number, power)
        except OverflowError:
            expected = math.copysign(math.inf, number)
        assert mathematics("ldexp", number, power) == expected, power


def test_numbers_that_are_not_finite_have_no_power_of_two(mathematics):
    assert mathematics("frexp", math.inf, 0) == math.inf
    assert math.isnan(mathematics("frexp", math.nan, 0))
    assert mathematics("ldexp", -math.inf, -2000) == -math.inf


def test_sines_of_parameters_are_within_the_last_place(mathematics):
    for angle in (0.0, 1.0, -2.5, 1e5, 1e22, 1e-300):
        for name, exact in (("sin", math.sin(angle)), ("cos", math.cos(angle))):
            assert abs(mathematics(name, angle) - exact) <= 1.5 * math.ulp(exact)
