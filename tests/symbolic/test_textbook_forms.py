"""Eleven systems of textbooks: values of KanesMethod and of books, in no more operations than either."""

from __future__ import annotations

import pytest
from sympy import Matrix

from benchmarks.closed_forms.cases import CASES, Case, Entries
from benchmarks.closed_forms.document import document
from benchmarks.closed_forms.measuring import AGREEMENT, Result, difference
from tests.support.cases import slow_except

OPERATIONS = {
    "babyboot": (14, 20),
    "spherical_pendulum": (7, 17),
    "furuta_pendulum": (18, 27),
    "gantry_crane": (38, 140),
    "quarter_car": (0, 22),
    "double_pendulum": (19, 31),
    "triple_pendulum": (83, 111),
    "euler_top": (15, 33),
    "gyrostat": (3, 20),
    "bead_on_hoop": (2, 9),
    "cart_two_poles": (14, 19),
}
"""Exact counts in [A], on and above the diagonal, and in {f}. They may fall, and never grow."""


def entries(case: Case) -> Entries:
    form = case.closed_form()
    return Entries(Matrix(form.A), Matrix(form.f))


@pytest.mark.parametrize("case", slow_except(CASES, *CASES[::2]), ids=lambda case: case.name)
def test_values_and_operations(case: Case) -> None:
    """KanesMethod without `simplify` has the same values; so has the textbook, in no fewer operations."""
    own, book = entries(case), case.of_textbook()
    assert difference(own, case.by_kanes_method(simplify=False)) <= AGREEMENT
    assert difference(own, book) <= AGREEMENT
    assert own.operations == OPERATIONS[case.name]
    assert all(ours <= theirs for ours, theirs in zip(own.operations, book.operations, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_kanes_method_with_simplify_is_never_shorter(case: Case) -> None:
    theirs = case.by_kanes_method().operations
    assert all(ours <= other for ours, other in zip(OPERATIONS[case.name], theirs, strict=True))


def test_the_page_names_what_differs() -> None:
    case = CASES[1]
    good = Result(case, (7, 17), (7, 17), (7, 23), 0.01, 0.1, 1e-15)
    bad = Result(case, (7, 17), (7, 17), (7, 23), 0.01, 0.1, 1e-3)
    assert good.agrees
    assert not bad.agrees
    page = document([good, bad], 3)
    system = "| [spherical pendulum](../models/textbook/spherical_pendulum.toml)"
    assert f"{system} | 7 + 17 | 7 + 17 | 7 + 23 | 0.010 | 0.10 | 10 |\n" in page
    assert f"{system} (differs by 1.0e-03) | 7 + 17 |" in page
