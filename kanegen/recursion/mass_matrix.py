"""[A] by composite bodies: Eq. (43) regrouped so that nothing is computed twice.

Hold every joint outward of a freedom still: all bodies that the freedom carries move as one composite body.
Its unit speed then needs a force {F} and a moment {M} about the origin, and the work of that pair on every
freedom further inward is an entry of [A] (Featherstone 2008, section 6.2). The joint's turns are passed one at
a time, so that an angle's entry is simply a component of {M}, a translation's a component of {F}.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from sympy import Expr, S

from kanegen.recursion.bodies import Inertia, body_inertia
from kanegen.symbolic.definitions import Definitions, Symmetric, Vector
from kanegen.recursion.joints import NO_FREEDOM, JointMotion, Step
from kanegen.recursion.vectors import add, column, cross, dot, scale, unit
from kanegen.system import System


@dataclass(frozen=True)
class Column:
    """Force and moment that unit speed of `freedom` needs, about the current origin, in its frame."""

    freedom: int
    label: str
    force: Vector
    moment: Vector


Entries = dict[tuple[int, int], Expr]


def mass_matrix(system: System, motions: tuple[JointMotion, ...], definitions: Definitions) -> list[Expr]:
    """The entries of [A], row-major; both halves hold the same symbols."""
    own = [body_inertia(system, k, definitions) for k in range(1, system.number_of_bodies + 1)]
    columns: list[list[Column]] = [[] for _ in own]
    entries: Entries = {}
    for motion in reversed(motions):
        k, j = motion.body, motion.lower
        definitions.about(f"Body {k} ({system.bodies[k - 1].name}): composite body and columns of [A], Eq. (43)")
        composite, carried = own[k - 1], columns[k - 1]
        for step, frame in motion.inward():
            composite = _turn_composite(composite, step, frame, definitions)
            carried = _turn_columns(carried, composite, step, frame, entries, definitions)
        composite, carried = _slide(composite, carried, motion, entries, definitions)
        if j:
            own[j - 1] = own[j - 1].plus(composite, str(j), definitions)
            columns[j - 1] = columns[j - 1] + carried
    n = len(system.freedoms)
    return [entries.get((max(r, c), min(r, c)), S.Zero) for r in range(n) for c in range(n)]


def _record(entries: Entries, a: int, b: int, value: Expr) -> None:
    entries[max(a, b), min(a, b)] = value


def _turn_composite(composite: Inertia, step: Step, frame: str, definitions: Definitions) -> Inertia:
    return Inertia(
        composite.mass,
        definitions.vector(f"hc_{frame}", step.turn.down(composite.moment)),
        step.turn.down_symmetric(definitions, f"Ic_{frame}", composite.inertia),
    )


def _turn_columns(
    carried: list[Column],
    composite: Inertia,
    step: Step,
    frame: str,
    entries: Entries,
    definitions: Definitions,
) -> list[Column]:
    """Pass columns inward through a turn; its angle takes their entries and adds its own column."""
    turned = []
    for col in carried:
        if step.freedom != NO_FREEDOM:
            _record(entries, col.freedom, step.freedom, col.moment[step.axis])
        name = f"{col.label}_{frame}"
        force = definitions.vector(f"F_{name}", step.turn.down(col.force))
        turned.append(replace(col, force=force, moment=definitions.vector(f"M_{name}", step.turn.down(col.moment))))
    if step.freedom != NO_FREEDOM:
        axis = unit(step.axis)
        moment = column(composite.inertia, step.axis)
        _record(entries, step.freedom, step.freedom, moment[step.axis])
        turned.append(Column(step.freedom, f"{frame}", cross(axis, composite.moment), moment))
    return turned


def _slide(
    composite: Inertia, carried: list[Column], motion: JointMotion, entries: Entries, definitions: Definitions
) -> tuple[Inertia, list[Column]]:
    """Shift composite and columns from O_K to O_J; translations take their entries and add theirs."""
    for slide in motion.slides:
        for col in carried:
            value = definitions.define(f"A_{col.freedom}_{slide.freedom}", dot(slide.direction, col.force))
            _record(entries, col.freedom, slide.freedom, value)
        _record(entries, slide.freedom, slide.freedom, composite.mass)
    if not motion.lower:
        return composite, []
    shifted = [_shift_column(col, motion, definitions) for col in carried]
    moved = _shift_composite(composite, motion, definitions)
    for slide in motion.slides:
        label = f"{motion.body}s{slide.freedom}"
        force = definitions.vector(f"F_{label}", scale(composite.mass, slide.direction))
        moment = definitions.vector(f"M_{label}", cross(moved.moment, slide.direction))
        shifted.append(Column(slide.freedom, label, force, moment))
    return moved, shifted


def _shift_column(col: Column, motion: JointMotion, definitions: Definitions) -> Column:
    moment = add(col.moment, cross(motion.offset, col.force))
    return replace(col, moment=definitions.vector(f"M_{col.label}_{motion.lower}", moment))


def _shift_composite(composite: Inertia, motion: JointMotion, definitions: Definitions) -> Inertia:
    """About O_J: with {H} = {h} + m {d}, [I] - [d~][H~] - [h~][d~]."""
    d, h, name = motion.offset, composite.moment, f"{motion.body}j"
    shifted = definitions.vector(f"hc_{name}", add(h, scale(composite.mass, d)))
    sums = add(h, shifted)
    t = [definitions.define(f"dh_{name}_{'xyz'[i]}", d[i] * sums[i]) for i in range(3)]
    old = composite.inertia
    new = Symmetric(
        xx=old.xx + (t[1] + t[2]),
        yy=old.yy + (t[2] + t[0]),
        zz=old.zz + (t[0] + t[1]),
        xy=old.xy - (d.x * shifted.y + h.x * d.y),
        xz=old.xz - (d.x * shifted.z + h.x * d.z),
        yz=old.yz - (d.y * shifted.z + h.y * d.z),
    )
    return Inertia(composite.mass, shifted, definitions.symmetric(f"Ic_{name}", new))
