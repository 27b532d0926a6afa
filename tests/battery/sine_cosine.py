"""Sine and cosine of large and special angles, and of all angles: X11, X12 and X39."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product

import flint
import numpy as np

import kanegen as kg
from kanegen.c.minimax import minimax
from kanegen.c.sincos import SHARED, sincos_named
from kanegen.library.native import commands
from kanegen.library.native.build import program
from kanegen.measure.truth import truth
from kanegen.measure.truth.errors import bits_lost
from kanegen.options import SINCOS, Variant
from kanegen.program.precision import DOUBLE, FLOAT, Precision
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.c_programs import HERE
from tests.battery.experiments import Point, Row, Size, count, experiment
from tests.battery.measurement import FLAGS, PRECISIONS, PROMISE, Floats, built, forward, points, worst


@experiment("X11", "Large angles")
def large_angles(size: Size) -> Iterator[Row]:
    """Large angles are reduced without loss, since angles count as exact numbers."""
    powers = size.pick([0, 4, 7, 16], list(range(17)))
    system = scenes.tree(np.random.default_rng(11), [0, 1, 1, 3])
    for precision in PRECISIONS:
        found: list[Point] = []
        for power in powers:
            states = random_states(system, 8, power)
            states.x[:] *= 10.0**power
            found += points(10.0**power, forward(system, precision, states))
        over = f"4 hinges, angles up to 10^0 ... 10^{powers[-1]} rad, 8 states each"
        yield worst(precision.name, found, PROMISE, over)


def special(precision: Precision, multiples: int) -> Floats:
    """Return zeros, the smallest numbers, and the neighbours of multiples of pi/4, of both signs."""
    kind = precision.dtype.type
    info = np.finfo(precision.dtype)
    tiny = [info.smallest_subnormal, info.tiny, 1e-30, info.eps, info.eps / 2]
    near = np.array([kind(k * np.pi / 4) for k in range(1, multiples)], precision.dtype)
    around = [near, np.nextafter(near, kind(0)), np.nextafter(near, kind(np.inf))]
    positive = np.concatenate([np.array(tiny, precision.dtype), *around])
    angles: Floats = np.concatenate([[0.0], positive, -positive]).astype(np.float64)
    return angles


@experiment("X12", "Sine and cosine where they are zero, one or equal")
def sine_and_cosine(size: Size) -> Iterator[Row]:
    """The forcing of a mass of 1 kg at 1 m with a weight of 1 N is the sine or the cosine of its angle."""
    multiples = size.pick(40, 300)
    for precision, (name, gravity) in product(PRECISIONS, WEIGHTS.items()):
        system = scenes.planar([1.0], mass_center=[[1.0, 0.0, 0.0]], gravity=gravity)
        library = built(system, precision, ("forcing",))
        x = special(precision, multiples)[:, None]
        right = np.array([_exact(system, row, precision) for row in x])
        single = np.array([library.forcing(row, [0.0]) for row in x])
        for call, found in (("state", single), ("batch", library.forcing(x, np.zeros_like(x)))):
            lost = 2.0 ** bits_lost(found, right) - 1
            curve = [Point(abs(float(at)), float(e), 1.0) for at, e in zip(x[:, 0], lost[:, 0], strict=True)]
            over = f"{len(x)} angles: 0, the least, next to k pi/4 up to k = {multiples}"
            yield worst(f"{name}, {call}, {precision.name}", curve, "1 float from the nearest", over)
            if name == "sine":
                odd = [
                    a != b for a, b in zip(found[1:][: len(x) // 2], -found[1 + len(x) // 2 :], strict=True)
                ]
                yield count(f"odd function, {call}, {precision.name}", odd, over, "same bits")


WEIGHTS = {"sine": (1.0, 0.0, 0.0), "cosine": (0.0, 1.0, 0.0)}


def _exact(system: kg.System, x: Floats, precision: Precision) -> Floats:
    return truth(system, x, [0.0], outputs=("forcing",), unit_roundoff=precision.roundoff)["forcing"].value


BITS = 1300
"""Precision of the exact values (bit); subtracting multiples of pi/2 from an angle of 1e308 takes 1024."""

FLOATS = 0x7F800000
"""Number of floats from 0 to the largest."""

DIRECTIONS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
"""Directions of the weight for which the forcing of a mass is the sine or the cosine of its angle."""


@experiment("X39", "Sine and cosine over all angles")
def all_angles(size: Size) -> Iterator[Row]:
    """Errors in units of the last place, and absolute errors for polynomials."""
    step = size.pick(4001, 1)
    limit = float(SHARED[FLOAT].error.split()[0])
    over = f"{-(-FLOATS // step)} floats from 0 to the largest"
    for name, error in zip(("sine", "cosine"), _floats(step), strict=True):
        yield Row(f"{name}, float", error, limit, "units of the last place", over)
    angles = doubles(size.pick(1000, 100_000))
    limit = float(SHARED[DOUBLE].error.split()[0])
    over = f"{len(angles)} doubles up to the largest, many next to multiples of pi/2"
    for name, error in zip(
        ("sine", "cosine"), places(_computed("shared", DOUBLE, angles), angles), strict=True
    ):
        yield Row(f"{name}, double", error, limit, "units of the last place", over)
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
    """Return the largest errors of sine and cosine over every `step`-th float."""
    text = kg.generate(_mass(0), ("forcing",), precision="float").files["kanegen_sincosf.h"]
    files = {"kanegen_sincosf.h": text, "sines.c": (HERE / "sines.c").read_text()}
    driver = program("sines", files, {"sines.c": ["-std=c99", "-O2", "-ffp-contract=off"]})
    return [float(word) for word in commands.output([driver, str(step)]).split()]


def _mass(direction: int) -> kg.System:
    return scenes.planar([1.0], mass_center=[[1.0, 0.0, 0.0]], gravity=DIRECTIONS[direction])


def _computed(name: str, precision: Precision, angles: Floats) -> Floats:
    """Return (B, 2) sines and cosines of (B,) angles, computed as forcings of a mass."""
    variant = Variant(precision.name, sincos=name)
    columns = []
    for direction in (0, 1):
        library = kg.build(_mass(direction), ("forcing",), flags=FLAGS, tier=variant)
        found = library.forcing(angles[:, None], np.zeros((len(angles), 1)))[:, 0]
        columns.append(-found if direction == 0 else found)
    return np.column_stack(columns)


def doubles(amount: int) -> Floats:
    """Return angles of every size and sign, and angles next to multiples of pi/2."""
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
    """Return doubles next to multiples of pi/2 for every exponent, from denominators of continued
    fractions."""
    found = []
    with flint.ctx.workprec(2400):
        whole = int((2 / flint.arb.pi() * flint.arb(2) ** 2300).floor().unique_fmpz())
    one = 1 << 2352
    for exponent in range(-52, 972):
        # The multiples 1, 2, 3 ... of 2^exponent in turns of pi/2, of which only the fraction matters.
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
    """Return the largest errors of (B, 2) sines and cosines, in units of the last place."""
    worst = [0.0, 0.0]
    with flint.ctx.workprec(BITS):
        for angle, values in zip(angles.tolist(), found.tolist(), strict=True):
            for k, exact in enumerate(flint.arb(angle).sin_cos()):
                error = float(abs(flint.arb(values[k]) - exact).upper()) / math.ulp(float(exact))
                worst[k] = max(worst[k], math.inf if math.isnan(error) else error)
    return worst[0], worst[1]
