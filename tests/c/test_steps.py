"""Steps and rollouts in C: what compilers say, and the same bits for every width of SIMD vectors."""

from functools import cache
from itertools import product

import numpy as np
import pytest

import kanegen as kg
from kanegen.recursion.outputs import INTEGRATORS, METHODS
from tests.support.c_compilers import CPP, SANITIZERS, WARNINGS, C, code, printed, run
from tests.support.cases import slow_except
from tests.support.paths import MODELS
from tests.support.simd import wide

LEVELS = {"gcc": "-O1", "clang": "-O0"}


@cache
def source(name, precision="double"):
    """Return the C of a model with all methods: one with parameters, and one with quaternions and loads."""
    system = kg.load(MODELS / f"{name}.toml")
    methods = [method for method in METHODS.values() if method.needs_further is not None]
    names = (
        INTEGRATORS if system.speeds_are_rates else [one for method in methods for one in method.functions]
    )
    return kg.generate(system, names, precision=precision)


QUICK = ("clang", "satellite", "float")
EVERY = list(product(C, ("double_pendulum", "satellite"), ("double", "float", "long double")))


@pytest.mark.parametrize(
    ("compiler", "name", "precision"),
    [pytest.param(*one, marks=[] if one == QUICK else pytest.mark.slow) for one in EVERY],
)
def test_steps_are_clean(compiler, name, precision, tmp_path):
    folder = source(name, precision).write(tmp_path / "out")
    for file in (f"{name}.c", f"{name}_batch.c", "main.c"):
        run(*C[compiler], "-std=c99", LEVELS[compiler], *WARNINGS, "-c", file, "-o", "x.o", folder=folder)


def test_the_header_is_for_cpp_and_the_example_runs(tmp_path):
    """The example makes one step of 0.1 s, as the library does; it is C++, too, and runs under sanitizers."""
    system = kg.load(MODELS / "double_pendulum.toml")
    folder = kg.generate(system, ("step_rk4", "rollout_rk4")).write(tmp_path / "out")
    run(*CPP["g++"], "-x", "c++", "-fsyntax-only", "main.c", folder=folder)
    run(*C["gcc"], "-std=c99", *SANITIZERS, "main.c", *code("double_pendulum"), "-o", "main", folder=folder)
    found = printed(run("./main", folder=folder, ASAN_OPTIONS="detect_leaks=0"))
    x, y = kg.build(system, ("step_rk4",)).step([0.1, 0.2], [0.1, 0.2], [0.1, 0.2], step=0.1)
    assert found["step_rk4", "x_next"] == pytest.approx(x, rel=1e-15)
    assert found["step_rk4", "y_next"] == pytest.approx(y, rel=1e-15)


ITERATED = ("implicit_midpoint", "linearly_implicit", "variational_midpoint")


@pytest.mark.parametrize("method", slow_except(("rk4", *ITERATED), "implicit_midpoint"))
def test_the_width_of_vectors_changes_no_bit(method):
    """Lanes beside each other take different numbers of iterations, and the state of one overflows."""
    system = kg.load(MODELS / "double_pendulum.toml")
    rng = np.random.default_rng(3)
    x, y = rng.normal(size=(2, 13, 2))
    y[4] *= 1e80
    results = []
    for width in (1, 8):
        compiled = kg.build(system, (f"rollout_{method}",), flags=wide(width), on_status="ignore")
        results.append(compiled.rollout(x, y, steps=6, step=0.02))
    alone = [compiled.rollout(x[b], y[b], steps=6, step=0.02) for b in range(13)]
    for one in results:
        assert np.array_equal(one.y, np.array([each.y for each in alone]), equal_nan=True)
        assert one.made.tolist() == [int(each.made) for each in alone]
