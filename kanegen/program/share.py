"""Share the work of a long program among workers, threads that compute one state together.

A worker keeps its values in registers, of which a GPU gives few to each thread; what others need it leaves in
an array, the workspace, which all of them reach. Between two phases all workers wait for each other at a
barrier. Work is shared in groups of instructions, such as the inertia of one body in one pass over the tree:
groups of different limbs do not need each other.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from kanegen.program.cut import SOURCES, Part
from kanegen.program.ir import WORKSPACE, Array, Op, Program

COSTS = {Op.NEGATE: 0, Op.DIVIDE: 10, Op.SQRT: 10, Op.SIN: 25, Op.COS: 25}
"""Costs of operations in additions, about those of a GPU; 1 for the others."""

WAIT = 60
"""Costs in additions of a wait at a barrier for a value of another worker."""


@dataclass(frozen=True)
class Shared:
    """A program whose work several workers share.

    Attributes:
        programs: The program of each worker; the last tests the conditions of all outputs.
        barriers: For every worker the places in its instructions before which it waits for the others, as
            many for each.
        workspace: Numbers that workers leave for others.
        work: Cost of all instructions, in additions.
        time: Cost of the worker that needs longest, waits included.
    """

    programs: tuple[Program, ...]
    barriers: tuple[tuple[int, ...], ...]
    workspace: int
    work: int
    time: int


@dataclass(frozen=True)
class _Placed:
    """When and by whom a group of instructions is computed.

    Attributes:
        worker: Number of the worker.
        start: Costs before it.
        end: Costs up to its end.
    """

    worker: int
    start: int
    end: int


def share(program: Program, workers: int) -> Shared:
    """Return the programs of several workers, which together fill the outputs of `program`.

    Groups are placed in their order, each where it can begin first (list scheduling). Barriers are as few as
    separate every value from its readers in the resulting order of time.

    Args:
        program: A program without dead code.
        workers: Number of workers, from 2.
    """
    group_of = _groups(program)
    placed = _placed(program, group_of, workers)
    worker_of = {i: placed[group].worker for i, group in group_of.items()}
    crossing = _crossing(program, worker_of, workers - 1)
    slots = {i: slot for slot, i in enumerate(crossing)}
    array = Array(WORKSPACE, (max(len(slots), 1),), "SI", "values that workers leave for others")
    times = _barriers(program, group_of, placed)
    end = max(one.end for one in placed)
    programs, barriers = [], []
    for worker in range(workers):
        groups = sorted((k for k, one in enumerate(placed) if one.worker == worker), key=_start_of(placed))
        members = {group: [i for i in group_of if group_of[i] == group] for group in groups}
        part = Part(program, worker_of, slots, array, worker, is_last=worker == workers - 1)
        order = [i for group in groups for i in members[group]]
        programs.append(part.program(order))
        behind = [(placed[group_of[i]].start, part.place(i) + 1) for i in order]
        barriers.append(
            tuple(
                max((place for start, place in behind if start < time), default=0) for time in (*times, end)
            )
        )
    work = sum(COSTS.get(program.instructions[i].op, 1) for i in group_of)
    return Shared(tuple(programs), tuple(barriers), array.size, work, end + WAIT * (len(times) + 1))


def _start_of(placed: Sequence[_Placed]) -> Callable[[int], tuple[int, int]]:
    """Return the key by which a worker's groups are in order."""
    return lambda group: (placed[group].start, group)


def _groups(program: Program) -> dict[int, int]:
    """Return the group of every instruction that computes something: neighbours with one note."""
    found: dict[int, int] = {}
    group, note = 0, ""
    for i, instruction in enumerate(program.instructions):
        if instruction.op in SOURCES:
            continue
        if instruction.note and instruction.note != note:
            group, note = group + bool(found), instruction.note
        found[i] = group
    return found


def _placed(program: Program, group_of: Mapping[int, int], workers: int) -> list[_Placed]:
    """Return the place of each group: the worker where it begins first, of several one that has operands."""
    costs = [0] * (1 + max(group_of.values()))
    before: list[set[int]] = [set() for _ in costs]
    for i, group in group_of.items():
        instruction = program.instructions[i]
        costs[group] += COSTS.get(instruction.op, 1)
        before[group].update(group_of[j] for j in instruction.operands if j in group_of)
    placed: list[_Placed] = []
    for group, cost in enumerate(costs):
        needed = [placed[k] for k in before[group] - {group}]
        choices = []
        for worker in range(workers):
            ready = max((one.end + WAIT * (one.worker != worker) for one in needed), default=0)
            start = _gap(ready, max(cost, 1), [one for one in placed if one.worker == worker])
            choices.append((start, -sum(one.worker == worker for one in needed), worker))
        start, _, worker = min(choices)
        placed.append(_Placed(worker, start, start + max(cost, 1)))
    return placed


def _gap(ready: int, cost: int, taken: Sequence[_Placed]) -> int:
    """Return the first time from `ready` on at which a worker is free for as long as `cost`."""
    start = ready
    for one in sorted(taken, key=lambda one: one.start):
        if start + cost <= one.start:
            break
        start = max(start, one.end)
    return start


def _crossing(program: Program, worker_of: Mapping[int, int], last: int) -> list[int]:
    """Return the values that a worker leaves for others, in order; the last worker reads all conditions."""
    found = {
        j
        for i, worker in worker_of.items()
        for j in program.instructions[i].operands
        if j in worker_of and worker_of[j] != worker
    }
    for output in program.outputs:
        conditions = (*output.exists_if_positive, *output.accurate_if_positive)
        found.update(i for i in conditions if worker_of.get(i, last) != last)
    return sorted(found)


def _barriers(program: Program, group_of: Mapping[int, int], placed: Sequence[_Placed]) -> list[int]:
    """Return the fewest times that lie between every value and its readers by other workers."""
    spans = {
        (placed[group].start, placed[group_of[j]].end)
        for i, group in group_of.items()
        for j in program.instructions[i].operands
        if j in group_of and placed[group_of[j]].worker != placed[group].worker
    }
    times: list[int] = []
    for reads, written in sorted(spans):
        if not times or times[-1] < written:
            times.append(reads)
    return times


def most_live(program: Program) -> int:
    """Return the most computed or read values that later instructions need at one time, in program order."""
    last = {j: i for i, instruction in enumerate(program.instructions) for j in instruction.operands}
    ends = Counter(last.values())
    most = now = 0
    for i, instruction in enumerate(program.instructions):
        if instruction.op is Op.CONSTANT:
            ends.subtract([last[i]] if i in last else [])
            continue
        now += i in last
        most = max(most, now)
        now -= ends[i]
    return most
