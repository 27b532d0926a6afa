"""Sine and cosine: right for every angle, with the same bits wherever they are computed, or as asked for."""

import math
from dataclasses import replace

import flint
import numpy as np
import pytest

import kanegen as kg
from kanegen.c import render
from kanegen.c.minimax import minimax
from kanegen.c.sincos import sincos_named
from kanegen.errors import OptionError
from kanegen.library import load
from kanegen.library.native import cache
from kanegen.library.native.calls import Constants
from kanegen.options import SINCOS, Variant
from kanegen.program.check import check
from kanegen.program.ir import Module, Op
from kanegen.program.precision import DOUBLE, FLOAT
from tests.support.c_compilers import C, run
from tests.support.cases import slow_except
from tests.support.command import kanegen
from tests.support.handmade import Listing, array, bits, description, evaluate
from tests.support.paths import PENDULUM

STRICT = ("-O1", "-ffp-contract=off")
POLYNOMIALS = [name for name in SINCOS if name.startswith("polynomial")]
SINE_7 = ["-0x1.55554526e88b3p-3", "0x1.11073b1a5ad8ep-7", "-0x1.9943e8ac5b85ap-13"]
COSINE_7 = [
    "-0x1.ffffffd0c70b2p-2",
    "0x1.55553e10b6626p-5",
    "-0x1.6c087ea6a10f5p-10",
    "0x1.9934366cbe8c1p-16",
]
ANGLES = 7
"""Of one state: enough to be taken side by side."""


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(cache.VARIABLE, str(tmp_path_factory.mktemp("cache")))
        yield


def program(count):
    """Return a program of the sines and cosines of `count` angles."""
    code = Listing()
    angles = [code.read("x", i) for i in range(count)]
    results = [code(op, angle) for angle in angles for op in (Op.SIN, Op.COS)]
    return check(code.program([array("x", count)], {array("f", 2 * count): results}))


def source(variant, count=1):
    made = Module(None, {"mass_matrix": program(count)})
    return render(description(parameters=False, loads=False), made, {}, variant)


def function(variant=None, flags=STRICT, compiler=None, count=1):
    """Return compiled C from (..., count) angles to (..., 2 count) sines and cosines."""
    return load(source(variant or Variant(), count), compiler, flags)._native.calls["mass_matrix"]


def call(compiled, x):
    return compiled._general(Constants(), (x,))[0]


def nearest_multiples():
    """Return the doubles nearest to multiples of pi/2, for every exponent, by continued fractions."""
    found = []
    with flint.ctx.workprec(2400):
        quarter = 2 / flint.arb.pi()
        whole = int((quarter * flint.arb(2) ** 2300).floor().unique_fmpz())
    for exponent in range(-52, 972):
        a, b = (whole << (exponent + 52)) % (1 << 2352), 1 << 2352
        previous, last = 1, 0
        while a:
            step = b // a
            previous, last = last, step * last + previous
            a, b = b - step * a, a
            if last >= 2**53:
                break
            if last >= 2**46:
                found.append(math.ldexp(last << max(0, 53 - last.bit_length()), exponent))
    return np.array(found)


def angles():
    rng = np.random.default_rng(8)
    multiples = rng.integers(0, 63_662, 1500) * (np.pi / 2)
    large = np.exp(rng.uniform(math.log(1e5), math.log(1.7e308), 4000))
    limits = [5e-324, 2.3e-308, 1e5, np.nextafter(1e5, 2e5), np.finfo(float).max]
    everyday = [rng.uniform(-7, 7, 4000), rng.uniform(-1e5, 1e5, 2000), 10.0 ** rng.uniform(-300, 0, 300)]
    close = [multiples, np.nextafter(multiples, 1e9), np.nextafter(multiples, 0)]
    return np.concatenate([*everyday, *close, large, -large[:500], nearest_multiples(), limits])


def truth(x):
    """Return balls that contain sines and cosines."""
    with flint.ctx.workprec(1300):
        return [flint.arb(v).sin_cos() for v in x.tolist()]


def places(found, exact):
    """Return the largest errors of sine and cosine in units of the last place."""
    with flint.ctx.workprec(1300):
        return [
            max(
                float(abs(flint.arb(v) - pair[k]).upper()) / math.ulp(float(pair[k]))
                for v, pair in zip(found[:, k].tolist(), exact, strict=True)
            )
            for k in (0, 1)
        ]


def test_every_angle_is_right_to_the_last_place():
    x = angles()
    found = call(function(), x[:, None])
    assert max(places(found, truth(x))) < 0.81


def test_zeros_keep_their_sign_and_what_is_no_number_stays_none():
    x = np.array([0.0, -0.0, 5e-324, -5e-324, np.inf, -np.inf, np.nan])
    nan = np.nan
    for name in ("shared", "libm", "polynomial-5", "polynomial-15"):
        for precision in ("double", "float") if name != "libm" else ("double",):
            least = float(np.finfo(precision if precision == "double" else np.float32).smallest_subnormal)
            given = np.where(np.abs(x) == 5e-324, np.sign(x) * least, x)
            found = call(function(Variant(precision, sincos=name)), given[:, None])
            assert bits(found[:, 0]) == bits([0.0, -0.0, least, -least, nan, nan, nan]), name
            assert bits(found[:, 1]) == bits([1.0, 1.0, 1.0, 1.0, nan, nan, nan]), name


@pytest.mark.parametrize("precision", slow_except(("double", "float"), "double"))
@pytest.mark.parametrize("name", slow_except(("shared", "polynomial-7"), "shared"))
def test_one_angle_many_and_batches_of_every_width_have_the_same_bits(name, precision):
    variant = Variant(precision, sincos=name)
    x = np.random.default_rng(9).uniform(-7, 7, (40, ANGLES))
    x[::3] *= 1e4
    x[5, 2], x[6, 3], x[11, 6] = 1e30, np.nan, -3e7
    alone = [[call(function(variant), [angle]) for angle in row] for row in x[:12]]
    expected = bits(np.reshape(alone, (12, 2 * ANGLES)))
    for width in (1, 2, 4, 8):
        compiled = function(variant, (*STRICT, f"-DKANEGEN_LANES={width}"), count=ANGLES)
        whole = call(compiled, x)
        assert bits(whole[:12]) == expected, width
        assert bits(whole) == bits([call(compiled, row) for row in x]), width
        assert bits(call(compiled, x[3:26])) == bits(whole[3:26])


@pytest.mark.parametrize("precision", slow_except(("double", "float"), "double"))
def test_every_compiler_and_level_gives_the_same_bits(precision):
    x = np.random.default_rng(10).uniform(-9, 9, (30, ANGLES)) * np.logspace(0, 30, 30)[:, None]
    found = set()
    for command in C.values():
        for flags in (("-O0",), ("-O3", "-march=native")):
            strict = (*flags, "-ffp-contract=off")
            compiled = function(Variant(precision), strict, " ".join(command), ANGLES)
            found.add(tuple(bits(call(compiled, x))))
            found.add(tuple(bits([call(compiled, row) for row in x])))
    assert len(found) == 1


@pytest.mark.parametrize("compiler", C.values(), ids=C)
def test_reassociation_does_not_harm_the_reduction(compiler):
    """pi/2 is subtracted in parts, which a compiler that may add in any order must not join."""
    loose = ("-O3", "-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math")
    x = np.concatenate([nearest_multiples()[:400], np.arange(1.0, 400.0) * (np.pi / 2)])
    exact = truth(x)
    compiled = function(flags=loose, compiler=" ".join(compiler))
    assert max(places(call(compiled, x[:, None]), exact)) < 1.6
    assert max(places(np.array([call(compiled, [v]) for v in x]), exact)) < 1.6


def test_floats_of_every_size():
    """The test takes every 4001st float; a benchmark takes all."""
    x = np.arange(0, np.float32(np.inf).view(np.int32), 4001, dtype=np.int32).view(np.float32)
    found = call(function(Variant("float")), x[:, None])
    for column, f in enumerate((np.sin, np.cos)):
        exact = f(x.astype(float))
        place = np.spacing(np.abs(exact.astype(np.float32))).astype(float)
        assert (np.abs(found[:, column] - exact) / place).max() < 0.8


def test_the_c_library_itself():
    x = np.concatenate([np.random.default_rng(11).normal(size=500) * 50, [0.0, -0.0, 1e300]])
    compiled = function(Variant(sincos="libm"))
    found = call(compiled, x[:, None])
    assert bits(found) == bits([evaluate(program(1), x=[v])["f"] for v in x])
    assert bits(found) == bits([call(compiled, [v]) for v in x])
    files = source(Variant(sincos="libm"), ANGLES).files
    assert "kanegen_sincos.h" not in files
    assert "kanegen_sincos" not in "".join(files.values())
    assert "Sine and cosine are those of the C library" in files["handmade.h"]


@pytest.mark.parametrize("name", slow_except(POLYNOMIALS, *POLYNOMIALS[::3]))
@pytest.mark.parametrize("precision", [DOUBLE, FLOAT], ids=["double", "float"])
def test_the_error_of_a_polynomial_is_what_the_header_says(name, precision):
    found = minimax(int(name.partition("-")[2]), precision)
    x = np.concatenate([np.linspace(-8, 8, 4001), np.geomspace(1e3, 1e30, 500)])
    x = x.astype(precision.dtype).astype(float)
    values = call(function(Variant(precision.name, sincos=name)), x[:, None])
    for column, claimed in enumerate((found.sine_error, found.cosine_error)):
        exact = np.array([float(pair[column]) for pair in truth(x)])
        error = np.abs(values[:, column] - exact).max()
        both = max(found.sine_error, found.cosine_error)  # odd multiples of pi/2 exchange them
        assert error < 1.05 * both + 2 * precision.roundoff + 2.0**-53
        assert error > 0.8 * claimed
    header = source(Variant(precision.name, sincos=name)).files["handmade.h"]
    assert sincos_named(name, precision).error in " ".join(header.replace("\n *", " ").split())
    assert sincos_named(name, precision).error.endswith(f"{2 * precision.roundoff:.1e} by roundoff")


def test_coefficients_are_the_same_on_every_machine():
    """The coefficients of degree 7 equal, bit for bit, those that another machine computed."""
    found = minimax(7, DOUBLE)
    assert [c.hex() for c in found.sine] == SINE_7
    assert [c.hex() for c in found.cosine] == COSINE_7


def test_higher_degrees_are_better():
    errors = [minimax(degree, DOUBLE).error for degree in range(5, 16, 2)]
    assert errors == sorted(errors, reverse=True)
    assert errors[0] < 1.4e-6
    assert errors[-1] < 1e-17


def test_no_function_of_the_library_is_left(tmp_path):
    system = kg.load(PENDULUM)
    for precision in ("double", "float"):
        made = kg.generate(system, tier=Variant(precision))
        written = made.write(tmp_path / precision)
        for file in ("double_pendulum.c", "double_pendulum_batch.c"):
            run("gcc", "-std=c99", "-O0", "-c", file, folder=written)
            undefined = run("nm", "-u", f"{file[:-2]}.o", folder=written).split()[1::2]
            assert not any("sin" in name or "cos" in name for name in undefined), undefined


def test_choices_that_do_not_exist():
    with pytest.raises(OptionError, match=r"^unknown sincos 'polynomial-6'\. Known are 'shared', "):
        Variant(sincos="polynomial-6")
    with pytest.raises(
        OptionError, match="'polynomial-7' does not go with precision 'long double', which takes"
    ):
        replace(Variant("long double"), sincos="polynomial-7")
    with pytest.raises(
        OptionError, match="'libm' does not go with precision 'double-double', which takes shared"
    ):
        Variant("double-double", sincos="libm")


def test_the_command_line(tmp_path):
    out = tmp_path / "out"
    kanegen("generate", PENDULUM, "-o", str(out), "--sincos", "polynomial-9")
    assert "sincos: polynomial-9" in (out / "double_pendulum.h").read_text()
    assert "polynomials of degree 9 and 10" in " ".join((out / "README.md").read_text().split())
    result = kanegen("check", PENDULUM, "--states", "20", "--sincos", "libm")
    assert "passed" in result.stdout.lower() or "ok" in result.stdout.lower()
    error = kanegen("check", PENDULUM, "--sincos", "table", status=2).stderr
    assert error.startswith("error: unknown sincos 'table'. Known are 'shared', 'libm', 'polynomial-5'")
