"""A system in a notebook: its tree as a picture, and below it the order of {x} and {y} and what acts."""

from __future__ import annotations

from collections.abc import Iterator

from markupsafe import Markup

from kanegen.errors import counted
from kanegen.model.body import Body
from kanegen.model.coordinates import FREEDOMS, NOTES, ORIENTATIONS
from kanegen.model.description import SystemDescription
from kanegen.model.joint import Joint
from kanegen.model.numbers import Number, factor_text
from kanegen.model.system_numbers import expression_summaries
from kanegen.pictures.html import MOST_ROWS, folded, name, python, sentence, shown, table
from kanegen.pictures.tree import Mark, Node, tree_svg

_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
"""Digits below the line, for the indices of freedoms."""


def system_svg(system: SystemDescription, most: int | None = None) -> str:
    """Return the picture of the tree of a system; `most` is the largest number of bodies that are drawn."""
    bodies, freedoms = _size(system)
    return tree_svg([*map(_node, system.bodies)], f"{system.name}: {bodies}, {freedoms}", most)


def system_html(system: SystemDescription) -> str:
    """Return the HTML of a system for a notebook."""
    bodies, freedoms = _size(system)
    gravity = ", ".join(map(_short, system.gravity))
    rest = system.number_of_bodies - MOST_ROWS
    hint = sentence("… {} more bodies: {}", rest, python("system.picture()")) if rest > 0 else Markup("")
    return shown(
        sentence("{}, {}, gravity ({}) m/s²", bodies, freedoms, gravity, strong=system.name),
        Markup(system_svg(system, MOST_ROWS)),
        hint,
        *_parts(system),
    )


def _size(system: SystemDescription) -> tuple[str, str]:
    """Return the numbers of bodies and of freedoms in words."""
    return counted(system.number_of_bodies, "body", "bodies"), counted(len(system.freedoms), "freedom")


def _node(body: Body) -> Node:
    """Return a body as the picture shows it."""
    loads = "takes loads" if body.loads else ""
    return Node(
        body.lower, _mark(body.joint), body.name, (_moving(body.joint), f"{_short(body.mass)} kg", loads)
    )


def _mark(joint: Joint) -> Mark:
    """Return what a joint does."""
    turns, slides = sum(joint.moving[:3]), sum(joint.moving[3:])
    marks = {
        (0, 0): Mark.WELDED,
        (1, 0): Mark.TURNS,
        (0, 1): Mark.SLIDES,
        (3, 0): Mark.BALL,
        (3, 3): Mark.FREE,
    }
    return marks.get((turns, slides), Mark.SEVERAL)


def _moving(joint: Joint) -> str:
    """Return the freedoms of a joint that move, with the name that the model gives to the joint."""
    parts = [_symbol(index) for index, moves in enumerate(joint.moving) if moves]
    if joint.coordinates != ORIENTATIONS[0]:
        parts = [joint.coordinates, *parts[3:]]
    elif joint.sequence != NOTES and any(joint.moving[:3]):
        parts.append(f"({joint.sequence})")
    for word, flags in (("prescribed", joint.prescribed), ("coupled", joint.coupled)):
        if any(flags):
            parts.append(f"({word})" if flags == joint.moving else f"(some {word})")
    return " ".join([*([f"{joint.name}:"] if joint.name else []), *(parts or ["fixed"])])


def _short(value: Number) -> str:
    """Return a number or expression as text, a whole number without a fraction."""
    return factor_text(value).removesuffix(".0")


def _symbol(index: int) -> str:
    """Return the letter of a freedom with its index, such as θ₃ or s₁."""
    return FREEDOMS[index].replace("theta", "θ").translate(_SUBSCRIPTS)


def _parts(system: SystemDescription) -> Iterator[Markup]:
    """Yield the folded parts below the picture, those that are not empty."""
    yield folded("Order of {x} and {y}", _coordinates(system), _speeds(system))
    if system.parameters:
        rows = [(one.name, repr(one.value)) for one in system.parameters]
        yield folded("Parameters, with their defaults", table(("name", "default"), rows, "system.parameters"))
    lines = {
        "Expressions of parameters": expression_summaries(system),
        "Force elements": tuple(element.summary for element in system.named_force_elements),
        "Couplings": system.coupling_equations,
        "Motors": system.motor_summaries,
        "Contacts": tuple(contact.summary for contact in system.contacts),
        "Locked freedoms at other values than zero": system.locked_summaries,
        "Prescribed freedoms": system.prescribed_names,
        "Points": tuple(f"{point.name} on {system.bodies[body - 1].name}" for body, point in system.points),
    }
    for title, summaries in lines.items():
        if summaries:
            yield folded(title, table((), [(line,) for line in summaries], "system.as_table()"))


def _coordinates(system: SystemDescription) -> Markup:
    """Return the table of {x}."""
    pairs = zip(system.coordinate_names, system.coordinates, strict=True)
    rows = [(place, name(label), one.unit) for place, (label, one) in enumerate(pairs)]
    return table(("place in {x}", "coordinate", "unit"), rows, "system.coordinate_names")


def _speeds(system: SystemDescription) -> Markup:
    """Return the table of {y}; a sentence where it has the order of {x}."""
    if system.speeds_are_rates:
        return sentence("The speeds {} are the rates of these coordinates, in the same order.", "{y}")
    rows = [
        (place, name(label), f"{freedom.unit}/s")
        for place, (label, freedom) in enumerate(zip(system.speed_names, system.freedoms, strict=True))
    ]
    return table(("place in {y}", "speed", "unit"), rows, "system.speed_names")
