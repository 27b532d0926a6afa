"""Sine and cosine themselves: every float, doubles where reduction is hardest, and polynomials: X39."""

from __future__ import annotations

import math
from collections.abc import Iterator

import flint
import numpy as np

import kanegen as kg
from kanegen.c.minimax import minimax
from kanegen.c.sincos import SHARED, sincos_named
from kanegen.library.native import commands
from kanegen.library.native.build import program
from kanegen.options import SINCOS, Variant
from kanegen.program.precision import DOUBLE, FLOAT, Precision
from tests.battery import scenes
from tests.battery.drivers import HERE
from tests.battery.measuring import FLAGS, PRECISIONS, Floats
from tests.battery.rows import Row, Size, subject

BITS = 1300
"""Of the exact values; an angle of 1e308 less multiples of pi/2 takes 1024 of them."""

FLOATS = 0x7F800000
"""Those from 0 to the largest."""

DIRECTIONS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
"""Of a weight of 1 N that makes {f} of a mass of 1 kg at 1 m the sine or the cosine of its angle."""


@subject("X39", "Sine and cosine over all angles")
def sine_and_cosine(size: Size) -> Iterator[Row]:
    """In units of the last place where they are as exact as can be; polynomials by their absolute error."""
    step = size.pick(4001, 1)
    limit = float(SHARED[FLOAT].error.split()[0])
    over = f"{-(-FLOATS // step)} floats from 0 to the largest"
    for name, worst in zip(("sine", "cosine"), _floats(step), strict=True):
        yield Row(f"{name}, float", worst, limit, "units of the last place", over)
    angles = doubles(size.pick(1000, 100_000))
    limit = float(SHARED[DOUBLE].error.split()[0])
    over = f"{len(angles)} doubles up to the largest, many next to multiples of pi/2"
    for name, worst in zip(
        ("sine", "cosine"), places(_computed("shared", DOUBLE, angles), angles), strict=True
    ):
        yield Row(f"{name}, double", worst, limit, "units of the last place", over)
    polynomials = [name for name in SINCOS if sincos_named(name, DOUBLE) and name != "shared"]
    for precision in PRECISIONS:
        for name in size.pick(polynomials[:2], polynomials):
            yield _polynomial(name, precision, size.pick(1000, 100_000))


def _polynomial(name: str, precision: Precision, amount: int) -> Row:
    angles = np.random.default_rng(39).uniform(-8.0, 8.0, amount).astype(precision.dtype).astype(np.float64)
    found = _computed(name, precision, angles)
    error = float(np.abs(found - np.column_stack([np.sin(angles), np.cos(angles)])).max())
    limit = minimax(int(name.partition("-")[2]), precision).error + 2 * precision.roundoff + DOUBLE.roundoff
    return Row(
        f"{name}, {precision.name}", error, limit, "absolute, as the header says", f"{amount} angles up to 8"
    )


def _floats(step: int) -> list[float]:
    """Largest errors of sine and cosine over every `step`-th float."""
    text = kg.generate(_mass(0), ("forcing",), precision="float").files["kanegen_sincosf.h"]
    files = {"kanegen_sincosf.h": text, "sines.c": (HERE / "sines.c").read_text()}
    driver = program("sines", files, {"sines.c": ["-std=c99", "-O2", "-ffp-contract=off"]})
    return [float(word) for word in commands.output([driver, str(step)]).split()]


def _mass(direction: int) -> kg.System:
    return scenes.planar([1.0], mass_center=[[1.0, 0.0, 0.0]], gravity=DIRECTIONS[direction])


def _computed(name: str, precision: Precision, angles: Floats) -> Floats:
    """(B, 2) absolute values of sines and cosines of (B,) angles, with the signs of the exact ones."""
    variant = Variant(precision.name, sincos=name)
    columns = []
    for direction in (0, 1):
        library = kg.build(_mass(direction), ("forcing",), flags=FLAGS, tier=variant)
        found = library.forcing(angles[:, None], np.zeros((len(angles), 1)))[:, 0]
        columns.append(-found if direction == 0 else found)
    return np.column_stack(columns)


def doubles(amount: int) -> Floats:
    """Angles of every size and sign, and next to multiples of pi/2."""
    rng = np.random.default_rng(39)
    multiples = rng.integers(0, 63_662, amount) * (np.pi / 2)
    large = np.exp(rng.uniform(math.log(1e5), math.log(1.7e308), 2 * amount))
    everyday = [rng.uniform(-7, 7, 3 * amount), rng.uniform(-1e5, 1e5, amount)]
    close = [multiples, np.nextafter(multiples, np.inf), np.nextafter(multiples, 0.0), nearest_multiples()]
    small = 10.0 ** rng.uniform(-307, 0, amount // 4)
    limits = [5e-324, 2.3e-308, 1e5, np.nextafter(1e5, 2e5), np.finfo(np.float64).max]
    found: Floats = np.concatenate([*everyday, *close, large, -large[: amount // 4], small, -small, limits])
    return found


def nearest_multiples() -> Floats:
    """Doubles next to multiples of pi/2, for every exponent: denominators of continued fractions."""
    found = []
    with flint.ctx.workprec(2400):
        whole = int((2 / flint.arb.pi() * flint.arb(2) ** 2300).floor().unique_fmpz())
    one = 1 << 2352
    for exponent in range(-52, 972):
        # The turns of 1, 2, 3 ... times 2^exponent, of which only the fraction matters.
        a, b = (whole << (exponent + 52)) % one, one
        previous, last = 1, 0
        while a and last < 2**53:
            if last >= 2**46:
                found.append(math.ldexp(last << 53 - last.bit_length(), exponent))
            step = b // a
            previous, last = last, step * last + previous
            a, b = b - step * a, a
    return np.array(sorted(value for value in set(found) if math.isfinite(value)))


def places(found: Floats, angles: Floats) -> tuple[float, float]:
    """Largest errors of (B, 2) sines and cosines in units of the last place."""
    worst = [0.0, 0.0]
    with flint.ctx.workprec(BITS):
        for angle, values in zip(angles.tolist(), found.tolist(), strict=True):
            for k, exact in enumerate(flint.arb(angle).sin_cos()):
                error = float(abs(flint.arb(values[k]) - exact).upper()) / math.ulp(float(exact))
                worst[k] = max(worst[k], math.inf if math.isnan(error) else error)
    return worst[0], worst[1]
