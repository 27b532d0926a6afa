"""Programs whose matrices hold every value once."""

from dataclasses import replace

import numpy as np
import pytest

from kanegen.program.check import check
from kanegen.program.distinct import SMALL, distinct_values
from kanegen.program.ir import Op
from tests.support.handmade import Listing, array, evaluate

LENGTH = 18
X, A, F = array("x", LENGTH), array("A", LENGTH, LENGTH), array("f", SMALL)
LOWER = replace(A, pattern=tuple((i, j) for i in range(LENGTH) for j in range(i + 1)))


def products(is_symmetric=True, output=A, is_zero=lambda i, j: j >= LENGTH - 3):
    """Return the program of the products of two coordinates, for i <= j, with zeros."""
    code = Listing()
    x = [code.read("x", k) for k in range(LENGTH)]
    zero = code.number(0.0)
    known = {}

    def product(i, j):
        i, j = sorted((i, j)) if is_symmetric else (i, j)
        if i < j and is_symmetric and is_zero(i, j):
            return zero
        if (i, j) not in known:
            known[i, j] = code(Op.MULTIPLY if i <= j else Op.SUBTRACT, x[i], x[j])
        return known[i, j]

    places = range(output.size)
    filled = [k for k in places if output is not LOWER or k % LENGTH <= k // LENGTH]
    program = code.program([X], {output: [product(*divmod(k, LENGTH)) for k in filled]})
    (only,) = program.outputs
    return replace(program, outputs=(replace(only, places=tuple(filled) if output is LOWER else None),))


def test_each_element_is_found_at_its_place():
    program, x = products(), np.random.default_rng(1).normal(size=LENGTH)
    found = distinct_values(program)
    check(found.program)
    (output,) = found.program.outputs
    assert len(output.values) == len(set(output.values)) < LENGTH * (LENGTH + 1) // 2
    values = evaluate(found.program, x=x)["A"]
    assert values[list(found.places["A"])].tolist() == evaluate(program, x=x)["A"].ravel().tolist()


def test_a_lower_triangle_has_places_for_its_elements():
    program, x = products(output=LOWER, is_zero=lambda i, j: (i + j) % 2), np.arange(2.0, 2.0 + LENGTH)
    found = distinct_values(program)
    values = evaluate(found.program, x=x)["A"]
    rows, columns = np.tril_indices(LENGTH)
    places = np.reshape(found.places["A"], A.shape)[rows, columns]
    assert len(values) < len(rows) * 2 / 3
    assert values[places].tolist() == np.where((rows + columns) % 2, 0.0, x[rows] * x[columns]).tolist()


@pytest.mark.parametrize(("is_symmetric", "output"), [(False, A), (True, F)], ids=["different", "vector"])
def test_others_stay_as_they_are(is_symmetric, output):
    program = products(is_symmetric, output)
    found = distinct_values(program)
    assert found.program == program
    assert found.places == {}
