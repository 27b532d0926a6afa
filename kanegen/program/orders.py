"""Orders in which the instructions of a program can stand: the same values, and so the same bits."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Iterator

from kanegen.program.ir import Op, Program
from kanegen.program.selection import dependencies, subprogram

ROWS = 6
"""Rows of a matrix that are finished together: enough to overlap, few enough to keep their values near."""

WINDOW = 64
"""Instructions among which the one on the longest chain comes first, so that values stay near their uses."""

CYCLES = {Op.DIVIDE: 13, Op.SQRT: 20}
"""Cycles from the beginning to the end of operations that take longer than `USUAL_CYCLES`."""

USUAL_CYCLES = 3
"""Cycles from the beginning to the end of an addition or a multiplication."""

_SOURCES = (Op.INPUT, Op.CONSTANT)


def by_rows(program: Program) -> Program:
    """Compute a few rows of the outputs at a time, with all that they need, the last rows first."""
    done: set[int] = set()
    order: list[int] = []
    for wanted in _groups(program):
        missing = dependencies(program, wanted, done)
        done.update(missing)
        order += missing
    return subprogram(program, order)


def depth_first(program: Program) -> Program:
    """Compute each result in turn, and for each instruction first the operand that needs most registers.

    This is the order of Sethi and Ullman (1970) for trees; values that are used several times stand where
    they are used first.
    """
    needs = _needs(program)
    done: set[int] = set()
    order: list[int] = []
    for result in program.results():
        path = [(result, iter(_operands(program, result, needs)))] if result not in done else []
        done.add(result)
        while path:
            i, rest = path[-1]
            j = next((j for j in rest if j not in done), None)
            if j is None:
                order.append(i)
                path.pop()
            else:
                done.add(j)
                path.append((j, iter(_operands(program, j, needs))))
    return subprogram(program, order)


def longest_chain_first(program: Program) -> Program:
    """Compute first what the longest chain of operations waits for, among the next `WINDOW` instructions."""
    chains, users = _chains(program), _users(program)
    missing = [len(set(x.operands)) for x in program.instructions]
    ready: list[tuple[int, int]] = []
    order: list[int] = []
    seen = 0
    while len(order) < len(program.instructions):
        while seen < len(program.instructions) and seen - len(order) < WINDOW:
            if not missing[seen]:
                heapq.heappush(ready, (-chains[seen], seen))
            seen += 1
        _, i = heapq.heappop(ready)
        order.append(i)
        for user in users[i]:
            missing[user] -= 1
            if not missing[user] and user < seen:
                heapq.heappush(ready, (-chains[user], user))
    return subprogram(program, order)


def _groups(program: Program) -> Iterator[list[int]]:
    """Yield results that are computed together: vectors, rows of matrices up to the diagonal, the rest."""
    for output in program.outputs:
        if not output.array.is_matrix:
            yield [*output.values, *output.exists_if_positive, *output.accurate_if_positive]
    for output in program.outputs:
        if output.array.is_matrix:
            rows: dict[int, list[int]] = {}
            for index, value in output.elements():
                row, column = output.array.entry(index)
                rows.setdefault(row, []).extend([value] if column <= row else [])
            for last in range(max(rows, default=-1) + 1, 0, -ROWS):
                yield [value for row in range(max(0, last - ROWS), last) for value in rows.get(row, ())]
    yield list(program.results())


def _needs(program: Program) -> list[int]:
    """Return about how many registers each value needs to be computed."""
    needs: list[int] = []
    for x in program.instructions:
        of_operands = sorted((needs[j] for j in set(x.operands)), reverse=True)
        taken = max((need + place for place, need in enumerate(of_operands)), default=0)
        needs.append(0 if x.op in _SOURCES else max(1, taken))
    return needs


def _operands(program: Program, i: int, needs: list[int]) -> Iterable[int]:
    return sorted(program.instructions[i].operands, key=lambda j: needs[j], reverse=True)


def _users(program: Program) -> list[list[int]]:
    """Return for each value the instructions that use it."""
    users: list[list[int]] = [[] for _ in program.instructions]
    for i, x in enumerate(program.instructions):
        for j in set(x.operands):
            users[j].append(i)
    return users


def _chains(program: Program) -> list[int]:
    """Return for each value the cycles of the longest chain of operations from there to a result."""
    chains = [0] * len(program.instructions)
    for i in range(len(chains) - 1, -1, -1):
        x = program.instructions[i]
        chains[i] += 0 if x.op in (*_SOURCES, Op.NEGATE) else CYCLES.get(x.op, USUAL_CYCLES)
        for j in x.operands:
            chains[j] = max(chains[j], chains[i])
    return chains
