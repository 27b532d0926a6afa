"""`FiniteMatrix`: the products of SymPy's own matrices, which stay of this class."""

import numpy as np
import pytest
import sympy
from sympy import ImmutableMatrix

import kanegen as kg
from kanegen.symbolic.matrices import FiniteMatrix
from tests.support.paths import MODELS


def random_matrix(rng: np.random.Generator, rows: int, columns: int) -> ImmutableMatrix:
    """Return a matrix of symbols, sums, sines, numbers and zeros."""
    a, b = sympy.symbols("a b", real=True)
    kinds = [
        sympy.S.Zero,
        sympy.S.Zero,
        sympy.S.One,
        sympy.Integer(-3),
        sympy.Float(0.25),
        a,
        -b,
        a + b,
        sympy.sin(a),
    ]
    return ImmutableMatrix(rows, columns, [kinds[rng.integers(len(kinds))] for _ in range(rows * columns)])


@pytest.mark.parametrize("seed", range(6))
def test_products_are_those_of_sympy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    left, right = random_matrix(rng, 3, 4), random_matrix(rng, 4, 5)
    expected = left * right
    for one, other in ((FiniteMatrix(left), FiniteMatrix(right)), (FiniteMatrix(left), right)):
        assert one * other == expected
        assert isinstance(one * other, FiniteMatrix)
    assert isinstance(left * FiniteMatrix(right), FiniteMatrix)
    assert isinstance(FiniteMatrix(left).T + FiniteMatrix(left).T, FiniteMatrix)
    whole = FiniteMatrix([[1, 2], [3, 4]])
    assert whole * whole == ImmutableMatrix([[7, 10], [15, 22]])


def test_a_derivation_asks_of_no_product_whether_it_is_finite(monkeypatch: pytest.MonkeyPatch) -> None:
    """SymPy's product of matrices of expressions, which asks that, is never called."""
    monkeypatch.setattr("sympy.polys.matrices.sdm.sdm_matmul_exraw", None)
    equations = kg.derive(kg.load(MODELS / "furuta_pendulum.toml"))
    assert equations.closed_form().A.shape == equations.f.shape[:1] * 2


def test_code_and_texts_name_the_class_of_sympy() -> None:
    """Functions of mpmath, whose code SymPy writes, know SymPy's classes only; so does what reads `srepr`."""
    x = sympy.Symbol("x")
    matrix = FiniteMatrix([[x, 2 * x]])
    assert sympy.lambdify([x], matrix, "mpmath")(3) == sympy.lambdify(
        [x], ImmutableMatrix(matrix.tolist()), "mpmath"
    )(3)
    assert sympy.srepr(matrix).startswith("ImmutableDenseMatrix(")
