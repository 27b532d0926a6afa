"""Couplings: freedoms that follow others, as the second finger of a gripper, a gear or a differential does.

A coupling is the linear equation x_freedom = sum of a_i x_i + offset. It holds in every state, so the coupled
freedom is in neither {x} nor {y}: its rate is sum of a_i y_i, and its effort adds a_i times to that of
freedom i. A coupling may name freedoms that are coupled themselves, or prescribed. `ordered` looks up all
names and lists the couplings so that each one names earlier ones at most.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.body import Body
from kanegen.model.coordinates import FREEDOMS, SPEED_KINDS, Freedom
from kanegen.model.numbers import Number, factor_text, number, toml_number, value_of

Terms = tuple[tuple[str, Number], ...]
"""Names of freedoms, each with its factor."""


@dataclass(frozen=True)
class Coupling:
    """A freedom whose coordinate is a linear function of other coordinates: x = sum of a_i x_i + offset.

    An angle may drive a translation; its factor then has the unit m/rad.

    Attributes:
        freedom: Name of the coupled freedom: that of its joint, or `<body>.theta1` to `<body>.s3`.
        terms: Factors a_i by name of the freedom that they multiply; kept as (name, factor) pairs.
        offset: Value where all other coordinates of the equation are zero (rad, m).

    Raises:
        ModelError: If a name is no string, there are no terms, or a factor is zero or no number.

    Example:
        kg.Coupling("left_finger", {"right_finger": 1.0})
    """

    freedom: str
    terms: Mapping[str, Number] | Terms
    offset: Number = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.freedom, str):
            raise ModelError(f"coupling: the freedom {quoted(self.freedom)} is no name.")
        label = f"coupling of {quoted(self.freedom)}"
        pairs = tuple(self.terms.items() if isinstance(self.terms, Mapping) else _pairs(self.terms, label))
        validation.store(self, terms=tuple(_term(name, factor, label) for name, factor in pairs))
        validation.store(self, offset=number(self.offset, f"{label}: offset"))
        if not pairs:
            raise ModelError(
                f"{label}: no other freedom is named, so it would be constant. Lock it, or name a freedom "
                "with its factor, such as {'right_finger': 1.0}."
            )
        validation.unique(f"{label}: freedom", [name for name, _ in self.pairs])

    @property
    def pairs(self) -> Terms:
        """The terms as (name, factor) pairs."""
        return tuple(self.terms.items()) if isinstance(self.terms, Mapping) else self.terms

    def equation(self) -> str:
        """Return the equation in one line, as comments in generated code and `kanegen info` show it.

        Example:
            kg.Coupling("left", {"right": -1.0}, 0.5).equation()  # "left = -1.0 right + 0.5"
        """
        parts = [f"{factor_text(factor)} {name}" for name, factor in self.pairs]
        parts += [str(toml_number(self.offset))] if self.offset != 0 else []
        return f"{self.freedom} = {' + '.join(parts)}"

    def numbers(self) -> Iterator[Number]:
        """Yield the factors, then the offset.

        Example:
            list(kg.Coupling("left", {"right": -1.0}, 0.5).numbers())  # [-1.0, 0.5]
        """
        yield from (factor for _, factor in self.pairs)
        yield self.offset

    def map_numbers(self, change: Callable[[Number], Number]) -> Coupling:
        """Return the same coupling with `change` applied to every number.

        Example:
            plain = coupling.map_numbers(value_of)  # parameters at their defaults
        """
        terms = tuple((name, change(factor)) for name, factor in self.pairs)
        return replace(self, terms=terms, offset=change(self.offset))

    def as_table(self) -> dict[str, Any]:
        """Return the table `[[coupling]]` of a model file, defaults left out.

        Example:
            kg.Coupling("left", {"right": -1.0}).as_table()
        """
        terms = {name: toml_number(factor) for name, factor in self.pairs}
        table: dict[str, Any] = {"freedom": self.freedom, "terms": terms}
        return table if self.offset == 0 else {**table, "offset": toml_number(self.offset)}


_N = TypeVar("_N", bound=Number)


@dataclass(frozen=True)
class CoupledFreedom(Generic[_N]):
    """A coupled freedom, with the freedoms that it follows.

    Attributes:
        freedom: The coupled freedom.
        terms: Each freedom that it follows, free, prescribed or coupled itself, with its factor.
        offset: Value where all of them are zero (rad, m).
    """

    freedom: Freedom
    terms: tuple[tuple[Freedom, _N], ...]
    offset: _N


def with_permanent_names(couplings: Iterable[Coupling], bodies: Sequence[Body]) -> tuple[Coupling, ...]:
    """Return the couplings with names that do not change when a freedom is locked: `<body>.<freedom>`.

    Raises:
        ModelError: If a name is unknown, or a freedom is coupled twice or cannot be coupled.
    """
    known, named = _names(bodies), []
    for coupling in couplings:
        label = f"coupling of {quoted(coupling.freedom)}"

        def permanent(name: str, label: str = label) -> str:
            freedom = _freedom(name, known, bodies, label)
            return f"{bodies[freedom.body - 1].name}.{FREEDOMS[freedom.index]}"

        pairs = tuple((permanent(other), factor) for other, factor in coupling.pairs)
        freedom = permanent(coupling.freedom)
        if freedom in dict(pairs):
            raise ModelError(f"{label}: it follows itself. Name freedoms that move without it.")
        named.append(Coupling(freedom, pairs, coupling.offset))
    validation.unique("coupled freedom", [coupling.freedom for coupling in named])
    for coupling in named:
        if bodies[known[coupling.freedom].body - 1].joint.prescribed[known[coupling.freedom].index]:
            raise ModelError(
                f"coupling of {quoted(coupling.freedom)}: its motion is prescribed. A freedom is one or the "
                "other."
            )
    return tuple(named)


def coupled_bodies(bodies: Sequence[Body], couplings: Sequence[Coupling]) -> tuple[Body, ...]:
    """Return the bodies with the freedoms of `couplings` coupled, and those that were coupled before free."""
    names = {coupling.freedom for coupling in couplings}
    changed = []
    for body in bodies:
        flags = tuple(f"{body.name}.{freedom}" in names for freedom in FREEDOMS)
        changed.append(body if flags == body.joint.coupled else _with_coupled(body, flags))
    return tuple(changed)


def ordered(couplings: Sequence[Coupling], bodies: Sequence[Body]) -> tuple[CoupledFreedom[Number], ...]:
    """Return the coupled freedoms, each after those coupled freedoms that it follows.

    Raises:
        ModelError: If freedoms follow each other in a circle; the message names them.
    """
    known = {coupling.freedom: coupling for coupling in couplings}
    places = _names(bodies)
    found: dict[str, CoupledFreedom[Number]] = {}
    for name in known:
        path = [name]
        while path:
            coupling = known[path[-1]]
            ahead = [other for other, _ in coupling.pairs if other in known and other not in found]
            if not ahead:
                terms = tuple((places[other], factor) for other, factor in coupling.pairs)
                found.setdefault(path[-1], CoupledFreedom(places[path[-1]], terms, coupling.offset))
                path.pop()
            elif ahead[0] in path:
                raise ModelError(_circle([*path[path.index(ahead[0]) :], ahead[0]]))
            else:
                path.append(ahead[0])
    return tuple(found.values())


def _pairs(terms: Any, label: str) -> list[tuple[Any, Any]]:
    """Return terms that are a sequence of (name, factor) pairs."""
    if not isinstance(terms, tuple):
        raise ModelError(f"{label}: expected terms such as {{'right_finger': 1.0}}, got {quoted(terms)}.")
    pairs = [validation.sequence(item, 2, f"{label}: term") for item in terms]
    return [(name, factor) for name, factor in pairs]


def _term(name: Any, factor: Any, label: str) -> tuple[str, Number]:
    """Return the name of a freedom and its factor; a wrong type or a factor of 0 is refused."""
    if not isinstance(name, str):
        raise ModelError(f"{label}: {quoted(name)} is no name of a freedom.")
    value = number(factor, f"{label}: factor of {quoted(name)}")
    if value == 0:
        raise ModelError(f"{label}: the factor of {quoted(name)} is zero. Leave the term out.")
    return name, value


def _names(bodies: Sequence[Body]) -> dict[str, Freedom]:
    """Return every freedom, moving or not, by every name that it has; permanent names come first."""
    found = {
        f"{body.name}.{FREEDOMS[index]}": Freedom(k, index)
        for k, body in enumerate(bodies, start=1)
        for index in range(len(FREEDOMS))
    }
    for k, body in enumerate(bodies, start=1):
        for index in range(len(FREEDOMS)):
            if name := body.joint.freedom_name(index):
                found.setdefault(name, Freedom(k, index))
    return found


def _freedom(name: str, known: Mapping[str, Freedom], bodies: Sequence[Body], label: str) -> Freedom:
    """Return the freedom of a name, which must move and have its rate as its speed."""
    if name not in known:
        moving = [other for other, one in known.items() if bodies[one.body - 1].joint.moving[one.index]]
        raise ModelError(f"{label}: there is no freedom {quoted(name)}. {did_you_mean(name, moving)}")
    freedom = known[name]
    body = bodies[freedom.body - 1]
    if not body.joint.moving[freedom.index]:
        raise ModelError(f"{label}: {quoted(name)} is locked. Free it, or leave it out of the coupling.")
    if not SPEED_KINDS[body.joint.speed_kinds[freedom.index]].is_rate:
        raise ModelError(
            f"{label}: the speeds of body {quoted(body.name)} are its angular velocity, so none is the rate "
            f"of {quoted(name)}. Keep angles and their rates there, or couple another freedom."
        )
    return freedom


def _with_coupled(body: Body, flags: tuple[bool, ...]) -> Body:
    """Return a body with the flagged freedoms coupled."""
    joint = body.joint
    free = tuple((a or b) and not flag for a, b, flag in zip(joint.free, joint.coupled, flags, strict=True))
    return replace(body, joint=replace(joint, free=free, coupled=flags))


def _circle(names: Sequence[str]) -> str:
    """Return the message for freedoms that follow each other in a circle."""
    first, *others = map(quoted, names)
    return (
        f"couplings: {first} follows {', which follows '.join(others)}: a circle. Leave one coupling out, so "
        "that a freedom remains that moves by itself."
    )


def values_of(coupled: Iterable[CoupledFreedom[Number]]) -> tuple[CoupledFreedom[float], ...]:
    """Return the coupled freedoms with parameters at their defaults."""
    return tuple(
        CoupledFreedom(
            one.freedom,
            tuple((freedom, value_of(factor)) for freedom, factor in one.terms),
            value_of(one.offset),
        )
        for one in coupled
    )
