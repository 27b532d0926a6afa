"""Subnormal numbers that count as zero, by name and inside the generated functions alone."""

import sys

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import OptionError
from kanegen.options import Variant
from tests.support.c_compilers import WARNINGS, C, run
from tests.support.cases import slow_except
from tests.support.paths import MODELS
from tests.support.systems import chain, eight_body

TINY = sys.float_info.min
FLUSH = "flush-to-zero"


def slider(mass):
    """Return one mass on a rail: [A] is the mass, and forward dynamics divides by it."""
    joint = kg.Joint(free=(False, False, False, True, False, False))
    return kg.System("slider", (kg.Body("mass", 0, mass, np.zeros((3, 3)), joint=joint),))


def still_here():
    return np.float64(TINY) * 0.5 > 0.0


@pytest.mark.parametrize("count", [None, 3, 2000])
def test_subnormal_results_are_zero_and_the_thread_keeps_its_own(count):
    """Without gravity {f} consists of squares of speeds, which are subnormal here."""
    system = kg.System("chain", chain(2).bodies, gravity=(0.0, 0.0, 0.0))
    shape = (system.number_of_bodies,) if count is None else (count, system.number_of_bodies)
    x, y = np.zeros(shape), np.full(shape, np.sqrt(TINY) / 64.0)
    strict = kg.build(system, threads=True)
    flushed = kg.build(system, tier=Variant(semantics=FLUSH), threads=True)
    x[..., 1] = 0.5
    exact, found = strict.forcing(x, y), flushed.forcing(x, y)
    assert (np.abs(exact) > 0.0).all()
    assert (np.abs(exact) < TINY).all()
    assert (found == 0.0).all()
    assert still_here()


@pytest.mark.parametrize("precision", slow_except(("double", "float"), "double"))
def test_other_numbers_have_the_same_bits(precision):
    system, rng = kg.load(MODELS / "six_revolute_arm.toml"), np.random.default_rng(0)
    x, y = rng.uniform(-1, 1, (2, 20, 6))
    outputs = ("forcing", "forward_dynamics")
    strict, flushed = (
        kg.build(system, outputs, tier=Variant(precision=precision, semantics=s)) for s in ("strict", FLUSH)
    )
    for states in ((x, y), (x[0], y[0])):
        np.testing.assert_array_equal(strict.forcing(*states), flushed.forcing(*states))
        np.testing.assert_array_equal(strict.forward_dynamics(*states), flushed.forward_dynamics(*states))


def test_a_status_comes_through():
    library = kg.build(slider(1.0), ("forward_dynamics",), tier=Variant(semantics=FLUSH))
    assert library.forward_dynamics([0.0], [0.0], tau=[3.0]) == 3.0
    with pytest.raises(kg.SingularError, match="the pivot of"):
        kg.build(chain(2), ("forward_dynamics",), tier=Variant(semantics=FLUSH)).forward_dynamics(
            [np.nan, np.nan], [0.0, 0.0]
        )
    assert still_here()


@pytest.mark.parametrize("compiler", slow_except(C, "gcc"))
def test_the_c_is_clean(compiler, tmp_path):
    variant = Variant(semantics=FLUSH)
    folder = kg.generate(eight_body(), ("forward_dynamics",), tier=variant).write(tmp_path / "out")
    for file in ("eight_body.c", "eight_body_batch.c"):
        run(*C[compiler], "-std=c99", *WARNINGS, "-c", file, "-o", tmp_path / "object.o", folder=folder)


@pytest.mark.parametrize("precision", ["long double", "double-double"])
def test_what_has_no_such_mode_refuses_it(precision):
    with pytest.raises(
        OptionError, match=f"precision '{precision}' needs subnormal numbers, which semantics"
    ):
        Variant(precision=precision, semantics=FLUSH)
