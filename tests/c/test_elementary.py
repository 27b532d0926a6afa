"""exp, log, tanh and atan2 in C: their errors, the same bits in every form, and what is special."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import flint
import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.c import render
from kanegen.c.elementary import ELEMENTARY, Elementary
from kanegen.library import load
from kanegen.library.native.calls import Constants
from kanegen.options import Variant
from kanegen.program.check import check
from kanegen.program.elementary import PLACES, SUBNORMAL_PLACES
from kanegen.program.ir import Module, Op
from kanegen.program.precision import DOUBLE, FLOAT, Precision
from tests.support.c_compilers import SANITIZERS, WARNINGS, C, code, run
from tests.support.cases import slow_except
from tests.support.handmade import Listing, array, bits, description
from tests.support.slide import slide

STRICT = ("-O1", "-ffp-contract=off")
FUNCTIONS = {"exp": Op.EXP, "log": Op.LOG, "tanh": Op.TANH}
ANGLE = "atan2"
LN2 = math.log(2)
KINDS = {"double": np.float64, "float": np.float32, "long double": np.longdouble}


@cache
def compiled(precision: str = "double", flags: tuple[str, ...] = STRICT, storage: str = ""):
    """Return compiled C from (..., 2) numbers x, y to (..., 4): exp x, log x, tanh x, atan2(y, x)."""
    code = Listing()
    x, y = code.read("x", 0), code.read("x", 1)
    results = [*(code(op, x) for op in FUNCTIONS.values()), code(Op.ATAN2, y, x)]
    program = check(code.program([array("x", 2)], {array("f", 4): results}))
    variant = Variant(precision, storage=storage)
    made = render(
        description(parameters=False, loads=False), Module(None, {"mass_matrix": program}), {}, variant
    )
    return load(made, None, flags)._native.calls["mass_matrix"]


def call(pairs: np.ndarray, precision: str = "double", **options) -> np.ndarray:
    return compiled(precision, **options)._general(Constants(), (pairs,))[0]


def numbers(name: str, rng: np.random.Generator, count: int) -> np.ndarray:
    """Return arguments of every size, and those next to every change of method."""
    uniform = rng.uniform
    match name:
        case "exp":
            halves = (rng.integers(-1000, 1000, count) + 0.5) * LN2 * (1 + uniform(-1e-9, 1e-9, count))
            found = [
                uniform(-708, 709.7, count),
                uniform(-1, 1, count),
                halves,
                10 ** uniform(-310, 0, count),
            ]
            found += [
                uniform(-745.2, -708, count),
                -(10 ** uniform(-310, 0, count)),
                [709.782712893384, -745.13],
            ]
        case "log":
            ends = [np.sqrt(2), np.sqrt(0.5), 1.0, 2.0, 0.5]
            near = [end * (1 + 10 ** uniform(-16, -1, count) * rng.choice([-1, 1], count)) for end in ends]
            found = [np.exp(uniform(-708, 709, count)), uniform(0.5, 2, 4 * count), *near]
            found += [
                10 ** uniform(-323, -308, count),
                [5e-324, 2.2250738585072014e-308, np.finfo(float).max],
            ]
        case "tanh":
            near = 0.55 * (1 + 10 ** uniform(-16, -1, count) * rng.choice([-1, 1], count))
            found = [uniform(-0.55, 0.55, count), uniform(-1.5, 1.5, count), uniform(-25, 25, count), near]
            found += [10 ** uniform(-323, 0, count), [5e-324, 1e300, -1e300]]
    return np.concatenate([np.asarray(part, float) for part in found])


def points(rng: np.random.Generator, count: int) -> np.ndarray:
    """Return points (x, y) of every direction and size, also next to the axes and the diagonals."""
    x, y = rng.normal(size=(2, 4 * count))
    scale, tiny = 10 ** rng.uniform(-150, 150, count), 10 ** rng.uniform(-17, -1, count)
    flat = np.stack([x[:count], tiny * y[:count]], axis=1)
    even = np.stack([x[:count], x[:count] * (1 + tiny)], axis=1)
    parts = [np.stack([x, y], axis=1), flat, flat[:, ::-1], even, even * [1, -1], flat * scale[:, None]]
    return np.concatenate(parts)


def exact(name: str, *operands: float) -> flint.arb:
    a = [flint.arb(value) for value in operands]
    return flint.arb.atan2(*a) if name == ANGLE else getattr(a[0], name)()


def worst(name: str, found: np.ndarray, *operands: np.ndarray) -> tuple[float, float]:
    """Return the largest errors of normal and of subnormal results, in units in the last place."""
    info = np.finfo(found.dtype)
    errors = {True: 0.0, False: 0.0}
    with flint.ctx.workprec(200):
        for value, *given in zip(found.tolist(), *(o.tolist() for o in operands), strict=True):
            truth = exact(name, *given)
            size = abs(float(truth))
            place = float(np.spacing(info.dtype.type(size)))
            error = float(abs(flint.arb(value) - truth).upper()) / place
            normal = size >= info.tiny
            errors[normal] = max(errors[normal], math.inf if math.isnan(error) else error)
    return errors[True], errors[False]


@pytest.mark.parametrize("precision", ["double", "float"])
@pytest.mark.parametrize("name", [*FUNCTIONS, ANGLE])
def test_errors_are_below_the_bounds(name: str, precision: str) -> None:
    rng, kind = np.random.default_rng(7), KINDS[precision]
    if name == ANGLE:
        pairs = points(rng, 700)
    else:
        x = numbers(name, rng, 1500)
        pairs = np.stack([x, x], axis=1)
    with np.errstate(over="ignore", under="ignore"):
        pairs = pairs.astype(kind)
    if name == "log":
        pairs = pairs[(pairs[:, 0] > 0) & np.isfinite(pairs[:, 0])]
    place = [*FUNCTIONS, ANGLE].index(name)
    found = call(pairs, precision)[:, place]
    sane = np.isfinite(found) & np.isfinite(pairs).all(axis=1)
    wide = pairs.astype(float)[sane]
    operands = (wide[:, 1], wide[:, 0]) if name == ANGLE else (wide[:, 0],)
    normal, subnormal = worst(name, found[sane], *operands)
    assert normal < PLACES[FUNCTIONS.get(name, Op.ATAN2)]
    assert subnormal < SUBNORMAL_PLACES


def test_every_4001st_float() -> None:
    """Against NumPy in double precision, whose errors are 2^-29 of a place of a float."""
    x = np.arange(0, np.float32(np.inf).view(np.int32), 4001, dtype=np.int32).view(np.float32)
    x = np.concatenate([x, -x])
    found = call(np.stack([x, x], axis=1), "float")
    with np.errstate(all="ignore"):
        for place, name in enumerate(FUNCTIONS):
            truth = getattr(np, name)(x.astype(float))
            size = np.abs(truth)
            tested = np.isfinite(truth) & (size < 3.4e38)
            space = np.spacing(size[tested].astype(np.float32)).astype(float)
            errors = np.abs(found[tested, place].astype(float) - truth[tested]) / space
            normal = size[tested] >= np.finfo(np.float32).tiny
            assert errors[normal].max() < PLACES[FUNCTIONS[name]]
            assert errors[~normal].max(initial=0) < SUBNORMAL_PLACES
            assert (np.isinf(found[:, place]) == (size.astype(np.float32) == np.inf)).all()


@pytest.mark.parametrize("precision", ["double", "float", "long double"])
def test_special_numbers(precision: str) -> None:
    inf, nan, pi = math.inf, math.nan, math.pi
    kind = KINDS[precision]
    of_one = [(zero, (1, -inf, 0)) for zero in (0.0, -0.0)]
    of_one += [(inf, (inf, inf, 1)), (-inf, (0, nan, -1))]
    of_one += [(1.0, (math.e, 0, math.tanh(1))), (-2.0, (math.exp(-2), nan, math.tanh(-2)))]
    for x, expected in of_one:
        found = call(np.array([x, 1.0], kind), precision).astype(float)
        np.testing.assert_allclose(found[:3], expected, rtol=1e-6)
    assert np.isnan(call(np.array([nan, 1.0], kind), precision)).all()
    assert np.isnan(call(np.array([1.0, nan], kind), precision)[3])
    angles = [((x, zero), angle) for x, angle in ((1.0, 0.0), (-1.0, pi), (0.0, 0.0)) for zero in (0.0, -0.0)]
    angles += [((-0.0, -0.0), 0.0), ((0.0, 2.0), pi / 2), ((-0.0, -2.0), -pi / 2)]
    angles += [((inf, 1.0), 0.0), ((-inf, 1.0), pi), ((1.0, inf), pi / 2), ((-1.0, -1e-30), -pi)]
    angles += [((inf, inf), pi / 4), ((-inf, inf), 3 * pi / 4), ((-inf, -inf), -3 * pi / 4)]
    for pair, angle in angles:
        found = float(call(np.array(pair, kind), precision)[3])
        assert found == pytest.approx(angle, rel=1e-6), pair


def test_limits_of_the_exponential() -> None:
    """The largest argument with a finite result, and the least with a result above 0, are the right ones."""
    for precision, kind in (("double", np.float64), ("float", np.float32)):
        info = np.finfo(kind)
        with mpmath.workdps(40):
            high = kind(float(mpmath.log(mpmath.mpf(float(info.max)))))
            low = kind(float(mpmath.log(mpmath.mpf(float(info.smallest_subnormal)) / 2)))
        around = [kind(high), np.nextafter(high, kind(0)), np.nextafter(high, kind(np.inf))]
        found = call(np.array([[x, x] for x in around], kind), precision)[:, 0]
        truth = np.exp(np.array(around, np.longdouble))
        assert (np.isinf(found) == (truth > np.longdouble(info.max))).all()
        assert call(np.array([low * kind(1.01), low], kind), precision)[0] == 0.0
        assert call(np.array([low * kind(0.99), low], kind), precision)[0] > 0.0


def test_odd_functions_and_monotony_next_to_changes_of_method() -> None:
    rng = np.random.default_rng(3)
    x = numbers("tanh", rng, 500)
    found = call(np.stack([x, 0 * x], axis=1))[:, 2]
    assert bits(found) == bits(-call(np.stack([-x, 0 * x], axis=1))[:, 2])
    assert (np.abs(found) <= 1).all()
    pairs = points(rng, 200)
    assert bits(call(pairs)[:, 3]) == bits(-call(pairs * [1, -1])[:, 3])


@pytest.mark.parametrize("precision", ["double", "float"])
def test_one_state_and_batches_of_every_width_have_the_same_bits(precision: str) -> None:
    kind = KINDS[precision]
    rng = np.random.default_rng(9)
    pairs = np.concatenate([rng.normal(size=(37, 2)) * 5, points(rng, 3)[:40]])
    pairs[:5, 0] = [0.0, math.inf, math.nan, -800.0, 1e-310]
    with np.errstate(over="ignore", under="ignore"):
        pairs = pairs.astype(kind)
    alone = bits([call(pair, precision) for pair in pairs])
    for width in (1, 2, 8):
        flags = (*STRICT, f"-DKANEGEN_LANES={width}")
        assert bits(call(pairs, precision, flags=flags)) == alone, width
        assert bits(call(pairs[3:20], precision, flags=flags)) == bits(call(pairs, precision)[3:20])


def test_bits_do_not_depend_on_optimisation_or_instructions() -> None:
    pairs = np.concatenate([points(np.random.default_rng(5), 100)])
    expected = bits(call(pairs))
    for flags in (
        ("-O0",),
        ("-O3",),
        ("-O2", "-march=native"),
        ("-O2", "-ftree-vectorize", "-funroll-loops"),
    ):
        assert bits(call(pairs, flags=(*flags, "-ffp-contract=off"))) == expected


def test_double_double_has_twice_the_digits() -> None:
    rng = np.random.default_rng(4)
    x = np.concatenate([rng.uniform(-300, 300, 60), rng.uniform(-1, 1, 60), 10 ** rng.uniform(-200, 0, 30)])
    x = np.concatenate([x, [0.55, -0.55, 1.0, 1 + 2e-16, 0.5, 2.0, 39.0, -50.0]])
    y = np.concatenate([rng.uniform(-300, 300, 60), rng.uniform(-1, 1, 60), x[120:]])
    pairs = np.zeros((len(x), 2, 2))
    pairs[:, 0, 0], pairs[:, 1, 0] = x, y
    pairs[:, 0, 1] = x * 2.0**-54 * rng.uniform(-1, 1, len(x))
    found = call(pairs, "double-double", storage="double-double")
    limits = {"exp": 10, "log": 20, "tanh": 10, "atan2": 10}
    with mpmath.workdps(80):
        for row, ((xh, xl), (yh, yl)) in zip(found.tolist(), pairs.tolist(), strict=True):
            a, b = mpmath.mpf(xh) + mpmath.mpf(xl), mpmath.mpf(yh) + mpmath.mpf(yl)
            truths = {"exp": mpmath.exp(a), "tanh": mpmath.tanh(a), "atan2": mpmath.atan2(b, a)}
            if a > 0:
                truths["log"] = mpmath.log(a)
            for place, name in enumerate([*FUNCTIONS, ANGLE]):
                value = mpmath.mpf(row[place][0]) + mpmath.mpf(row[place][1])
                if name in truths and 1e-290 < abs(truths[name]) < 1e290:
                    error = abs(value - truths[name]) / abs(truths[name]) * mpmath.mpf(2) ** 106
                    assert error < limits[name], (name, xh, yh)


def test_special_numbers_in_double_double() -> None:
    for x, expected in {
        0.0: (1, -math.inf, 0),
        math.inf: (math.inf, math.inf, 1),
        -1e9: (0, math.nan, -1),
    }.items():
        found = call(np.array([x, 0.0]), "double-double")
        np.testing.assert_array_equal(found[:3], expected)
    assert np.isnan(call(np.array([math.nan, 1.0]), "double-double")).all()
    assert call(np.array([-2.0, -0.0]), "double-double")[3] == math.pi
    assert call(np.array([0.0, 0.0]), "double-double")[3] == 0.0


ORDER = 14
"""Order of the power series that enclose the differences of polynomials and functions."""

PARTS = 256
"""Number of parts of an interval, on each of which a power series about its middle is taken."""

APPROXIMATION = {"exp": 0.08, "log": 0.02, "tanh": 0.04, "atan": 0.17}
"""What the polynomials may differ from their functions, in u; relative to the function, of e^r absolute."""


def difference(name: str, x: flint.arb_series, own: Elementary) -> flint.arb_series:
    """Return a polynomial less its function, where `kanegen.c.elementary` takes one for the other."""
    square = x * x
    sums = [flint.arb_series([0])] * 2
    for place, z in enumerate((x, square)):
        for coefficient in reversed(getattr(own, name)):
            sums[place] = sums[place] * z + flint.arb_series([flint.arb(coefficient)])
    match name:
        case "exp":
            return square * sums[0] - (x.exp() - 1 - x)
        case "log":
            return (x * square * sums[1] - (((1 + x) / (1 - x)).log() - 2 * x)) / 2
        case "tanh":
            growth = (2 * x).exp()
            return x + x * square * sums[1] - (growth - 1) / (growth + 1)
    return x + x * square * sums[1] - x.atan()


def largest_difference(name: str, own: Elementary, start: float, end: float) -> float:
    """Return a proven bound of the difference, relative to the argument except for exp."""
    relative, worst, half = name != "exp", 0.0, (flint.arb(end) - flint.arb(start)) / PARTS / 2
    for k in range(PARTS):
        middle = flint.arb(start) + half * (2 * k + 1)
        at_zero = relative and k == 0
        reach = 2 * half if at_zero else half
        about = flint.arb(0) if at_zero else middle
        near = difference(name, flint.arb_series([about, 1]), own)
        whole = difference(name, flint.arb_series([flint.arb(about.mid(), reach.upper()), 1]), own)
        terms = [abs(near[i]) for i in range(ORDER)] + [abs(whole[ORDER])]
        lowest = 1 if at_zero else 0  # the difference is 0 at 0
        total = sum((term * reach**i for i, term in enumerate(terms[lowest:])), flint.arb(0))
        if relative and not at_zero:
            total = total / (middle - half)
        worst = max(worst, float(total.upper()))
    return worst


@pytest.mark.parametrize("precision", [DOUBLE, FLOAT])
@pytest.mark.parametrize(("name", "end"), [("exp", 0.34675), ("log", 0.17161), ("tanh", 0.55), ("atan", 1.0)])
def test_polynomials_are_proven_near_their_functions(name: str, end: float, precision: Precision) -> None:
    """In ball arithmetic, for every argument of the interval; pi/4 is the least quotient of atan q and q."""
    with flint.ctx.workprec(200):
        before, flint.ctx.cap = flint.ctx.cap, ORDER + 1
        try:
            bound = largest_difference(name, ELEMENTARY[precision], -end if name == "exp" else 0.0, end)
        finally:
            flint.ctx.cap = before
    share = {"tanh": 1.1, "atan": 1.28}.get(name, 1.0)
    assert 0 < share * bound / precision.roundoff < APPROXIMATION[name]


@pytest.mark.parametrize("compiler", C)
@pytest.mark.parametrize(
    "variant",
    slow_except(
        (Variant(), Variant("float"), Variant("double-double"), Variant("long double")),
        *(Variant("float"), Variant("double-double")),
    ),
)
def test_no_warnings_and_no_undefined_behaviour(compiler: str, variant: Variant, tmp_path: Path) -> None:
    text = "tanh(x.q)*exp(y.q) + max(0, y.q, x.q) - min(1, x.p) + log(2 + abs(x.q))*sign(y.p) + atan2(x.q, 2)"
    system = slide(f"{text} + (1 if x.q > 0 and y.q <= 2 else pi)")
    kg.generate(system, ("forcing", "forcing_derivatives"), tier=variant).write(tmp_path / "c")
    for file in ("slide.c", "slide_batch.c"):
        run(
            *C[compiler], "-std=c99", "-O2", "-ffp-contract=off", *WARNINGS, "-c", file, folder=tmp_path / "c"
        )
    if compiler == "gcc":
        run("gcc", *SANITIZERS, "main.c", *code("slide"), "-o", "main", folder=tmp_path / "c")
        assert "forcing" in run("./main", folder=tmp_path / "c")
