"""Random couplings, and the state of a tree without them that a state of a coupled tree stands for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import kanegen as kg
from kanegen.model.coordinates import FREEDOMS, SPEED_KINDS, Freedom
from kanegen.model.numbers import Number, value_of
from tests.support.programs import Arrays


def rated_freedoms(system: kg.System) -> list[Freedom]:
    """Return the free and prescribed freedoms whose speeds are rates."""
    return [
        freedom
        for freedom in (*system.freedoms, *system.prescribed)
        if SPEED_KINDS[system.bodies[freedom.body - 1].joint.speed_kinds[freedom.index]].is_rate
    ]


def permanent_name(system: kg.System, freedom: Freedom) -> str:
    """Return `<body>.<freedom>`."""
    return f"{system.bodies[freedom.body - 1].name}.{FREEDOMS[freedom.index]}"


def random_couplings(
    system: kg.System, rng: np.random.Generator, share: float = 0.4, parameters: float = 0.3
) -> kg.System:
    """Return the system with random couplings: chains, several terms, across branches, of what is driven.

    Args:
        system: The system.
        rng: Source of everything random.
        share: Share of the free freedoms that become coupled; one freedom at least stays free.
        parameters: Share of the numbers that become parameters.
    """
    able = rated_freedoms(system)
    ahead = [able[i] for i in rng.permutation(len(able))]
    left, couplings, count = len(system.freedoms), list[kg.Coupling](), 0

    def number(value: float) -> Number:
        nonlocal count
        if rng.random() >= parameters:
            return float(value)
        count += 1
        return kg.Parameter(f"ratio{count}", float(value))

    while len(ahead) > 1:
        freedom = ahead.pop()
        if freedom in system.prescribed or left == 1 or rng.random() >= share:
            continue
        others = rng.permutation(len(ahead))[: int(rng.integers(1, 3))]
        factors = rng.choice([-1.0, 1.0, 0.5, 2.0, *rng.uniform(-1.5, 1.5, 3)], len(others))
        names = [permanent_name(system, ahead[i]) for i in others]
        terms = {name: number(factor) for name, factor in zip(names, factors.tolist(), strict=True)}
        offset = number(rng.uniform(-0.5, 0.5)) if rng.random() < 0.5 else 0.0
        couplings.append(kg.Coupling(permanent_name(system, freedom), terms, offset))
        left -= 1
    return system.with_couplings(*(couplings[i] for i in rng.permutation(len(couplings))))


def released(system: kg.System) -> kg.System:
    """Return the same tree with its coupled and prescribed freedoms free."""
    joints = (
        replace(b.joint, free=b.joint.moving, coupled=(False,) * 6, prescribed=(False,) * 6)
        for b in system.bodies
    )
    bodies = tuple(replace(b, joint=joint) for b, joint in zip(system.bodies, joints, strict=True))
    return replace(system, bodies=bodies, couplings=())


def rate_matrices(system: kg.System, parameters: dict[str, float] | None = None) -> tuple[np.ndarray, ...]:
    """Return the matrices from {y} and from prescribed rates to the released tree, and its offsets.

    The couplings are solved as linear equations in all freedoms at once.
    """
    other = released(system)
    size, known = len(other.freedoms), system.with_parameters(parameters or {})
    own, constant = np.eye(size), np.zeros(size)
    for one in known.coupled:
        row = other.places[one.freedom]
        constant[row] = value_of(one.offset)
        for follow, factor in one.terms:
            own[row, other.places[follow]] -= value_of(factor)
    free = np.zeros((size, len(system.freedoms)))
    driven = np.zeros((size, len(system.prescribed)))
    for matrix, freedoms in ((free, system.freedoms), (driven, system.prescribed)):
        for column, freedom in enumerate(freedoms):
            matrix[other.places[freedom], column] = 1.0
    return np.linalg.solve(own, free), np.linalg.solve(own, driven), np.linalg.solve(own, constant)


def released_state(system: kg.System, given: Arrays, parameters: dict[str, float] | None = None) -> Arrays:
    """Return the state of the released tree that a state of the coupled tree stands for."""
    other = released(system)
    free, driven, offset = rate_matrices(system, parameters)
    values, rates, seconds = given["prescribed"]
    x = np.zeros(len(other.coordinates))
    independent = np.zeros(len(system.freedoms))
    for coordinate, place in system.coordinate_places.items():
        freedom = Freedom(coordinate.body, coordinate.index)
        if freedom in system.places:
            independent[system.places[freedom]] = given["x"][place]
    moved = free @ independent + driven @ values + offset
    for coordinate, place in other.coordinate_places.items():
        freedom = Freedom(coordinate.body, coordinate.index)
        known = system.coordinate_places.get(coordinate)
        x[place] = moved[other.places[freedom]] if known is None else given["x"][known]
    y, ydot = free @ given["y"] + driven @ rates, free @ given["ydot"] + driven @ seconds
    rest = {name: value for name, value in given.items() if name not in ("prescribed", "tau")}
    return rest | {"x": x, "y": y, "ydot": ydot}
