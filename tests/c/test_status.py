"""Functions whose results hold only where pivots are positive: status, NaN, errors and warnings."""

import warnings

import numpy as np
import pytest

from kanegen.c import interface
from kanegen.c.function_body import statements
from kanegen.errors import ArrayError, KanegenWarning, SingularError
from kanegen.library import load
from kanegen.library.native import cache
from kanegen.program.ir import Op, Output, Program
from tests.support.c_compilers import SANITIZERS, WARNINGS, C, code, run
from tests.support.handmade import Listing, Y, bits, evaluate
from tests.support.pivot_programs import (
    ACCELERATION,
    BAD,
    GOOD,
    forward,
    source_with_pivots,
)


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(cache.VARIABLE, str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module", params=["in SIMD lanes", "one by one"])
def library(request):
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "one by one":
            patch.setattr(interface, "LARGEST_BATCH_ROW", 1)
        return load(source_with_pivots())


def test_states_that_are_regular(library):
    y, tau = np.random.default_rng(1).normal(size=(2, 5, 2))
    states = list(zip(GOOD, y, tau, strict=True))
    expected = [evaluate(forward(), x=a, y=b, tau=c)["acceleration"] for a, b, c in states]
    assert bits(library.forward_dynamics(GOOD, y, tau)) == bits(expected)
    assert bits([library.forward_dynamics(*state) for state in states]) == bits(expected)


@pytest.mark.parametrize(("freedom", "x"), BAD)
def test_a_singular_state_names_the_freedom(library, freedom, x):
    with pytest.raises(SingularError, match=f"^forward_dynamics: the pivot of .A. at freedom '{freedom}' is"):
        library.forward_dynamics(x, [1.0, 2.0])


def test_singular_states_of_a_batch_are_nan_and_counted(library):
    x = np.array([GOOD[0], BAD[0][1], *GOOD[1:], *(x for _, x in BAD[1:]), GOOD[0]])
    y = np.ones_like(x)
    with pytest.warns(
        KanegenWarning, match=r"^forward_dynamics: in 8 of 14 states .* in state 1 the pivot"
    ) as caught:
        found = library.forward_dynamics(x, y)
    assert caught[0].filename == __file__
    failed = [1, *range(6, 13)]
    assert np.isnan(found[failed]).all()
    regular = np.delete(np.arange(14), failed)
    assert bits(found[regular]) == bits(library.forward_dynamics(x[regular], y[regular]))


def test_a_pivot_that_is_a_number_is_not_watched():
    k = Listing()
    pivot, y = k.number(2.0), k.read("y", 0)
    output = Output(ACCELERATION, (k(Op.DIVIDE, y, pivot), y), (pivot, pivot))
    program = Program((Y,), tuple(k.instructions), (output,))
    text = "\n".join(statements(program))
    assert "if (!failed" not in text
    assert "int failed = 0;" in text


def test_no_forces_are_forces_of_zero(library):
    y = np.ones((5, 2))
    tau = np.array([0.5, -2.0])
    assert bits(library.forward_dynamics(GOOD[0], y[0])) == bits(
        library.forward_dynamics(GOOD[0], y[0], [0, 0])
    )
    assert bits(library.forward_dynamics(GOOD, y)) == bits(
        library.forward_dynamics(GOOD, y, np.zeros((5, 2)))
    )
    assert bits(library.forward_dynamics(GOOD, y, tau)) == bits(
        library.forward_dynamics(GOOD, y, np.tile(tau, (5, 1)))
    )
    with pytest.raises(ArrayError, match=r"^tau: expected shape \(2,\) or \(5, 2\), got \(4, 2\)\.$"):
        library.forward_dynamics(GOOD, y, y[:4])


def test_inverse_dynamics_needs_no_pivot(library):
    x, y, ydot = np.random.default_rng(2).normal(size=(3, 3, 2)) - 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = library.inverse_dynamics(x, y, ydot)
    assert bits(found) == bits(x * ydot + y * [1, 0] * 1.0)
    assert bits(found[0]) == bits(library.inverse_dynamics(x[0], y[0], ydot[0]))
    with pytest.raises(ArrayError, match=r"^ydot: expected real numbers, got None\.$"):
        library.inverse_dynamics(x, y, None)


def test_what_c_says(tmp_path):
    """Return status, count and NaN as documented, without a warning of any compiler."""
    made = source_with_pivots()
    for text in (
        "int handmade_forward_dynamics(const double x[2], const double y[2], const double tau[2],",
        "size_t handmade_forward_dynamics_batch(size_t count, const double *x,",
        "int handmade_inverse_dynamics(const double x[2],",
        "HANDMADE_NOT_FINITE where a number in acceleration is infinite or NaN",
        "@return 0, or HANDMADE_NOT_FINITE where a number in generalized_force is infinite or NaN",
        "@return 0, or the place in x, from 1, of a freedom whose pivot of [A] is not positive or NaN;",
        "@return how many states have a status other than 0; rows of acceleration that do not exist hold NaN",
    ):
        assert text in made.files["handmade.h"], text
    assert "`handmade_forward_dynamics` returns the place" in made.files["README.md"]
    folder = made.write(tmp_path / "out")
    (folder / "ask.c").write_text(
        '#include <stdio.h>\n#include "handmade.h"\n'
        "int main(void) {\n"
        "    const double x[3][2] = {{1.0, 0.0}, {2.0, 3.0}, {0.5, 2.0}}, y[3][2] = {{0.0}};\n"
        "    double found[3][2];\n"
        "    for (int i = 0; i < 3; ++i) {\n"
        '        printf("%d ", handmade_forward_dynamics(x[i], y[i], y[i], found[i]));\n'
        '        printf("%d ", found[i][0] != found[i][0] && found[i][1] != found[i][1]);\n'
        "    }\n"
        '    printf("%d", (int)handmade_forward_dynamics_batch(3, x[0], y[0], y[0], found[0]));\n'
        "    return 0;\n}\n"
    )
    for compiler in C.values():
        for file in ("handmade.c", "handmade_batch.c", "main.c"):
            run(*compiler, "-std=c99", "-O2", *WARNINGS, "-c", file, folder=folder)
    run(*C["gcc"], "-std=c99", *SANITIZERS, "ask.c", *code("handmade"), "-o", "ask", folder=folder)
    assert run("./ask", folder=folder) == "2 1 0 0 1 1 2"
