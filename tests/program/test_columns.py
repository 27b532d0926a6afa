"""Plans of solutions in loops over columns: their values against NumPy, their operations, and their zeros."""

from __future__ import annotations

import numpy as np
import pytest

from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.columns import ColumnSolution, column_solution
from kanegen.program.count import count
from kanegen.program.elimination import Elimination
from kanegen.program.evaluate import evaluate
from kanegen.program.expand import expanded
from kanegen.program.ir import Array, Output, Program

ROWS = 9


def tree(seed: int, rows: int = ROWS) -> dict[int, list[int]]:
    """Return the rows inward of each row of a random tree, in the order of elimination."""
    rng = np.random.default_rng(seed)
    inward: list[list[int]] = []
    for row in range(rows):
        lower = int(rng.integers(max(-1, row - 3), row))
        inward.append([*inward[lower], lower] if lower >= 0 else [])
    return {row: inward[row] for row in reversed(range(rows))}


def matrix_of(carriers: dict[int, list[int]], rng: np.random.Generator) -> np.ndarray:
    """Return a positive definite matrix that links the rows of each path and no others."""
    found = np.zeros((ROWS, ROWS))
    for row, inward in carriers.items():
        path = [*inward, row]
        entries = rng.uniform(-1, 1, (len(path), len(path)))
        found[np.ix_(path, path)] += entries @ entries.T + np.eye(len(path))
    return found


def solved(seed: int, *, units: bool) -> tuple[Program, ColumnSolution, np.ndarray, np.ndarray]:
    """Return a program that solves for random columns, its plan, and the matrix and the columns {b}."""
    rng, carriers = np.random.default_rng([seed, 1]), tree(seed)
    matrix = matrix_of(carriers, rng)
    dense = rng.uniform(-1, 1, (ROWS, 7))
    right = dense * (rng.random((ROWS, 7)) < rng.choice([0.1, 0.6, 1.0], 7))
    array = Array("matrix", matrix.shape, "1", "matrix"), Array("right", right.shape, "1", "columns")
    builder = Builder(array)
    entries = {
        (i, j): builder.input("matrix", ROWS * i + j)
        for i in range(ROWS)
        for j in range(i + 1)
        if matrix[i, j]
    }
    elimination = Elimination.of_matrix(builder, entries, carriers, builder.constant(1.0))
    columns = {
        c: {r: builder.input("right", 7 * r + c) for r in range(ROWS) if right[r, c]} for c in range(7)
    }
    plan = column_solution(elimination.carriers, columns, 7 if units else None)
    values = elimination.values_of(plan, columns, builder.constant(0.0))
    width = 7 + ROWS * units
    computed = {width * row + column for row, column in plan.elements()}
    zeros = tuple(place for place in range(ROWS * width) if place not in computed)
    zero = builder.constant(0.0)
    output = Output(
        Array("z", (ROWS, width), "1", "solution"),
        (*values, *[zero] * len(zeros)),
        places=zeros,
        solution=plan,
    )
    if units:
        right = np.hstack([right, -np.eye(ROWS)])
    return check(builder.program([output])), plan, matrix, right


def result(program: Program, matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the solution that the instructions compute."""
    inputs = {"matrix": list(matrix.ravel()), "right": list(right[:, :7].ravel())}
    return np.array(evaluate(program, inputs, np)["z"]).reshape(right.shape)


@pytest.mark.parametrize("units", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_the_solution_is_that_of_numpy(seed: int, units: bool) -> None:
    program, _, matrix, right = solved(seed, units=units)
    wanted = np.linalg.solve(matrix, -right)
    found = result(program, matrix, right)
    assert np.abs(found - wanted).max() < 1e-12 * np.abs(wanted).max()  # [A] has a condition below 1e3
    assert not found[np.abs(wanted) < 1e-15].any()  # what vanishes by structure is not computed


@pytest.mark.parametrize("seed", range(8))
def test_columns_of_the_inverse_are_symmetric_to_the_bit(seed: int) -> None:
    program, _, matrix, right = solved(seed, units=True)
    inverse = result(program, matrix, right)[:, 7:]
    assert (inverse == inverse.T).all()


@pytest.mark.parametrize("seed", range(8))
def test_loops_have_the_operations_of_straight_line_code(seed: int) -> None:
    program, plan, _, _ = solved(seed, units=True)
    straight, loops = count(expanded(program)), count(program)
    assert straight == loops
    assert straight["divide"] == ROWS
    assert len(plan.elements()) == len(set(plan.elements()))


def test_a_column_costs_a_multiple_of_the_pairs_of_rows() -> None:
    """On a chain: two products and two sums for each pair of rows, and one product for each row."""
    carriers = {row: list(range(row)) for row in reversed(range(ROWS))}
    plan = column_solution(carriers, {column: range(ROWS) for column in range(12)})
    (group,) = plan.groups
    assert group.columns == tuple(range(12)) and len(group.reduced) == len(group.solved) == ROWS
    assert sum(plan.operations.values()) == 12 * (ROWS + 4 * ROWS * (ROWS - 1) // 2)
    assert not plan.gains


def test_columns_of_other_branches_are_not_computed() -> None:
    """Two chains that nothing links, a column for each."""
    carriers = {3: [2], 2: [], 1: [0], 0: []}
    plan = column_solution(carriers, {0: [0], 1: [3]}, 2)
    assert [(one.columns, set(one.solved)) for one in plan.groups] == [((0,), {0, 1}), ((1,), {2, 3})]
    assert {frozenset(tree) for tree in plan.inverses} == {frozenset({0, 1}), frozenset({2, 3})}


def test_where_a_column_is_zero_in_a_branch_few_products_give_it() -> None:
    """A trunk of one row with branches of three; in the other branch rows follow from the trunk alone."""
    carriers = {6: [0, 4, 5], 5: [0, 4], 4: [0], 3: [0, 1, 2], 2: [0, 1], 1: [0], 0: []}
    plan = column_solution(carriers, {0: [0, 1, 2, 3]})
    (group,) = plan.groups
    lengths = {row: len(plan.sums[number]) for row, number in zip(group.solved, group.sums, strict=True)}
    assert lengths == {0: 0, 1: 1, 2: 2, 3: 3, 4: 1, 5: 1, 6: 1}


def test_a_small_group_joins_one_that_has_room_in_its_vectors() -> None:
    """Three columns and one that is zero in a further row fill one vector of four."""
    carriers = {row: list(range(row)) for row in reversed(range(ROWS))}
    dense, shorter = range(ROWS), range(ROWS - 1)
    joined = column_solution(carriers, {0: dense, 1: dense, 2: dense, 3: shorter})
    assert [one.columns for one in joined.groups] == [(0, 1, 2, 3)]
    full = column_solution(carriers, {**dict.fromkeys(range(4), dense), 4: shorter})
    assert [one.columns for one in full.groups] == [(0, 1, 2, 3), (4,)]


def test_inverses_with_zeros_inside_are_solved_for_column_by_column() -> None:
    """Rows 1 and 3 are related to row 2 by other rows, but not to one another."""
    carriers = {4: [0, 1], 3: [1], 2: [0], 1: [], 0: []}
    plan = column_solution(carriers, {}, 0)
    assert plan.inverses == ()
    assert {column for group in plan.groups for column in group.columns} == set(range(5))
    assert (3, 2) not in plan.elements() and (2, 3) not in plan.elements()
