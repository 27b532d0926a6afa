"""LaTeX of every symbol that SymPy would not print well by itself."""

from __future__ import annotations

import re

from sympy import Symbol

from kanegen.symbolic.equations import Equations
from kanegen.symbolic.symbols import (
    acceleration,
    coordinate,
    force,
    parameter,
    quaternion,
    quaternion_rate,
    relative_angular_velocity,
    relative_angular_velocity_rate,
    speed,
    torque,
)

_LETTER = re.compile("[A-Za-z]|alpha|beta|gamma|delta|epsilon|theta|kappa|mu|nu|rho|sigma|tau|phi|psi|omega")
_LETTER_AND_INDEX = re.compile(rf"(?:{_LETTER.pattern})(?:_?[A-Za-z]{{0,2}}\d*)")


def latex_names(equations: Equations) -> dict[Symbol, str]:
    """LaTeX of parameters, coordinates, speeds, accelerations, loads and intermediates."""
    names: dict[Symbol, str] = {}
    for given in equations.system.parameters:
        if not _LETTER_AND_INDEX.fullmatch(given.name):
            names[parameter(given)] = word(given.name)
    for freedom in equations.system.freedoms + equations.system.prescribed:
        k, index = freedom.body, freedom.index
        letter, place = r"\theta" if freedom.is_angle else "s", f"_{{{k},{freedom.axis + 1}}}"
        names[coordinate(k, index)] = letter + place
        if equations.system.spins(freedom):
            names[relative_angular_velocity(k, index)] = rf"{{\hat{{\omega}}'}}{place}"
            names[relative_angular_velocity_rate(k, index)] = rf"{{\dot{{\hat{{\omega}}}}'}}{place}"
        names[speed(k, index)] = rf"\dot{{{letter}}}" + place
        names[acceleration(k, index)] = rf"\ddot{{{letter}}}" + place
    for body in equations.bodies:
        if body.body.joint.is_quaternion:
            k = body.number
            for i, (element, rate) in enumerate(zip(quaternion(k), quaternion_rate(k), strict=True)):
                names[element] = rf"\epsilon_{{{k},{i}}}"
                names[rate] = rf"\dot{{\epsilon}}_{{{k},{i}}}"
        for axis in range(3):
            names[force(body.number, axis)] = f"{{F'}}_{{{body.number},{axis + 1}}}"
            names[torque(body.number, axis)] = f"{{M'}}_{{{body.number},{axis + 1}}}"
        names |= body.names.latex
    return names


def word(name: str) -> str:
    """A name of several letters, set as one word."""
    return rf"\mathit{{{escaped(name)}}}"


def escaped(plain: str) -> str:
    """Text with every character that LaTeX takes for a command escaped."""
    return "".join(f"\\{character}" if character in "{}_&%$#" else character for character in plain)
