"""Double-double: operations against mpmath, with the bounds of the papers; the same bits everywhere."""

import itertools
import subprocess

import cffi
import mpmath
import numpy as np
import pytest

from kanegen.c.double_double import DOUBLE_DOUBLE_HEADER
from kanegen.c.templates import fill
from tests.support.c_compilers import CPP, C, run
from tests.support.cases import slow_except

WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror".split()
UNIT = mpmath.mpf(2) ** -53

UNARY = ("sqrt", "sin", "cos", "negate")
BINARY = ("add", "subtract", "multiply", "divide")


def driver():
    """Return C that applies each function of the header to arrays."""
    lines = ['#include "kanegen_double_double.h"']
    for name, inputs in [(f, "a") for f in UNARY] + [(f, "ab") for f in BINARY]:
        arguments = "".join(f"const kanegen_double_double *{x}, " for x in inputs)
        values = ", ".join(f"{x}[i]" for x in inputs)
        head = f"void each_{name}(int count, {arguments}kanegen_double_double *c)"
        lines += [f"{head};", f"{head} {{ for (int i = 0; i < count; ++i) c[i] = dd_{name}({values}); }}"]
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("double_double")
    (path / "kanegen_double_double.h").write_text(
        fill("c99/kanegen_double_double.h", double_double=DOUBLE_DOUBLE_HEADER)
    )
    (path / "driver.c").write_text(driver())
    return path


class Compiled:
    def __init__(self, folder, command, *flags):
        name = f"{'_'.join([*command, *flags]).replace('/', '')}.so"
        shared = ["-std=c99", "-ffp-contract=off", "-shared", "-fPIC", "driver.c", "-o", name, "-lm"]
        run(*command, *flags, *shared, folder=folder)
        self.ffi = cffi.FFI()
        self.ffi.cdef("typedef struct { double high; double low; } kanegen_double_double;")
        for name_, inputs in [(f, 1) for f in UNARY] + [(f, 2) for f in BINARY]:
            arguments = ["const kanegen_double_double *"] * inputs + ["kanegen_double_double *"]
            self.ffi.cdef(f"void each_{name_}(int, {', '.join(arguments)});")
        self.library = self.ffi.dlopen(str(folder / name))

    def __call__(self, name, *inputs):
        """Apply a function to (count, 2) arrays of double-double numbers."""
        result = np.empty_like(inputs[0])
        pointers = [
            self.ffi.from_buffer("kanegen_double_double[]", np.ascontiguousarray(a))
            for a in (*inputs, result)
        ]
        getattr(self.library, f"each_{name}")(len(result), *pointers)
        return result


@pytest.fixture(scope="module")
def compiled(folder):
    return Compiled(folder, C["gcc"], "-O2")


def double_double(high, low):
    """Normalised double-double numbers from doubles and relative remainders in (-1, 1)."""
    return np.stack([high, np.spacing(np.abs(high)) / 2 * low * (1 - 1e-9)], axis=-1)


def numbers(seed, count=1500, spread=40):
    rng = np.random.default_rng(seed)
    high = rng.choice([-1.0, 1.0], count) * np.exp2(rng.uniform(-spread, spread, count))
    low = rng.uniform(-1, 1, count) * np.exp2(-rng.integers(0, 40, count).astype(float))
    return double_double(high, low * (rng.random(count) > 0.1))


def exact(values):
    with mpmath.workprec(400):
        return [mpmath.mpf(float(a)) + mpmath.mpf(float(b)) for a, b in values]


def largest_error(found, truth):
    """Return the largest relative error in units of u^2."""
    with mpmath.workprec(400):
        errors = [abs(v - t) / abs(t) if t else abs(v) for v, t in zip(exact(found), truth, strict=True)]
        return float(max(errors) / UNIT**2)


OPERATIONS = {
    "add": (lambda a, b: a + b, 3),
    "subtract": (lambda a, b: a - b, 3),
    "multiply": (lambda a, b: a * b, 5),
    "divide": (lambda a, b: a / b, 15),
}
"""What is exact, and the bound in u^2; 3 u^2 + 13 u^3 is above 3 u^2 by less than a millionth."""


@pytest.mark.parametrize("name", OPERATIONS)
def test_operations_keep_the_bounds_of_the_papers(compiled, name):
    function, bound = OPERATIONS[name]
    a, b = numbers(1), numbers(2)
    near = -a.copy()  # cancels nearly or wholly
    near[:, 0] += np.spacing(near[:, 0]) * np.random.default_rng(3).integers(-3, 4, len(a))
    for x, y in ((a, b), (a, double_double(-a[:, 0], a[::-1, 1] * 0)), (a, near)):
        with mpmath.workprec(400):
            truth = [function(p, q) for p, q in zip(exact(x), exact(y), strict=True)]
        found = compiled(name, x, y)
        assert largest_error(found, truth) <= bound * (1 + 1e-6)
        np.testing.assert_array_equal(found[:, 0] + found[:, 1], found[:, 0])  # normalised


def test_roots_keep_the_bound_of_the_paper(compiled):
    a = np.abs(numbers(4))
    a[:, 1] *= np.random.default_rng(5).choice([-1, 1], len(a))
    with mpmath.workprec(400):
        truth = [mpmath.sqrt(v) for v in exact(a)]
    assert largest_error(compiled("sqrt", a), truth) <= 25 / 8 * (1 + 1e-6)
    special = compiled("sqrt", np.array([[0.0, 0.0], [-1.0, 0.0], [np.nan, 0.0]]))
    np.testing.assert_array_equal(special[:, 0], [0.0, np.nan, np.nan])


def angles():
    """Angles of every size up to 1e6, and the nearest to multiples of pi/2 that double-double has."""
    rng = np.random.default_rng(6)
    everyday = double_double(rng.uniform(-10, 10, 700), rng.uniform(-1, 1, 700))
    every = np.exp2(rng.uniform(-60, 19.9, 700))
    doubles = np.stack([every, np.zeros(700)], axis=-1)
    turns = np.concatenate([np.arange(1, 200), rng.integers(200, 636_000, 300)])
    with mpmath.workprec(400):
        near = []
        for k in turns:
            target = int(k) * mpmath.pi / 2
            high = float(target)
            low = float(target - high)
            near += [(high, 0.0), (high, low), (high, float(np.nextafter(low, 1)))]
            octant = (2 * int(k) - 1) * mpmath.pi / 4
            near.append((float(octant), float(octant - float(octant))))
    return np.concatenate([everyday, doubles, near, [(1e6, 0.0), (-1e6, 0.0), (0.0, 0.0)]])


@pytest.mark.parametrize("name", ["sin", "cos"])
def test_sine_and_cosine(compiled, name):
    """The error is relative to the result, however near it is to 0; 2 u^2 is 2^-105."""
    x = angles()
    with mpmath.workprec(500):
        truth = [getattr(mpmath, name)(v) for v in exact(x)]
    assert 1 < largest_error(compiled(name, x), truth) <= 2


def test_angles_beyond_the_limit_are_refused(compiled):
    beyond = np.array([[np.nextafter(1e6, 2e6), 0.0], [-1e7, 0.0], [np.inf, 0.0], [np.nan, 0.0]])
    for name in ("sin", "cos"):
        assert np.isnan(compiled(name, beyond)[:, 0]).all()


def test_every_compiler_gives_the_same_bits(folder, compiled):
    inputs = {1: (np.concatenate([numbers(7), angles()]),), 2: (numbers(8), numbers(9))}
    expected = {f: compiled(f, *inputs[1 if f in UNARY else 2]).tobytes() for f in (*UNARY, *BINARY)}
    levels = [("-O0",), ("-O2",), ("-O3",), ("-O3", "-march=native")]
    for command, flags in itertools.product(C.values(), levels):
        other = Compiled(folder, command, *flags)
        for f, bits in expected.items():
            assert other(f, *inputs[1 if f in UNARY else 2]).tobytes() == bits, (command, flags, f)


@pytest.mark.parametrize("flags", slow_except(("-O0", "-O3 -march=native"), "-O0"))
@pytest.mark.parametrize("compiler", [*C, *CPP])
def test_the_header_is_clean(folder, compiler, flags):
    (folder / "user.cpp").write_text('#include "kanegen_double_double.h"\nint user() { return 0; }\n')
    for standard in ("c99", "c11") if compiler in C else ("c++98", "c++17"):
        file = "driver.c" if compiler in C else "user.cpp"
        command = ({**C, **CPP})[compiler]
        run(
            *command, f"-std={standard}", *flags.split(), *WARNINGS, "-c", file, "-o", "user.o", folder=folder
        )


@pytest.mark.parametrize("flags", ["-ffast-math", "-Ofast", "-funsafe-math-optimizations"])
def test_other_arithmetic_is_refused(folder, flags):
    result = subprocess.run(
        ["gcc", "-std=c99", flags, "-c", "driver.c", "-o", "x.o"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "double-double needs IEEE arithmetic" in result.stderr
