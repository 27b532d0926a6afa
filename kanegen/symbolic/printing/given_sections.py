"""Sections on what a system is given: parameters, loads, force elements. Each is there where they are."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from kanegen.model.system import System
from kanegen.symbolic.equations import Equations
from kanegen.symbolic.printing.statements import Names, Section, equation
from kanegen.symbolic.symbols import expression, parameter


def parameters(equations: Equations, names: Names) -> Iterator[Section]:
    """Their default values."""
    values = [(parameter(given), expression(given.value)) for given in equations.system.parameters]
    if values:
        statements = tuple(equation(symbol, value, names) for symbol, value in values)
        yield Section("Parameters", "Default values.", statements, is_list=True)


def loads(system: System) -> Iterator[Section]:
    """Those on bodies, then those on points."""
    if loaded := [(k, body.name) for k, body in enumerate(system.bodies, start=1) if body.loads]:
        note = (
            "F_K_i and M_K_i, Eq. (37), are components in body K of a force at its mass centre (N) and of a "
            f"torque (N m). Loaded: {_numbered(loaded)}."
        )
        yield Section("Loads", note)
    if loaded := [(p, point.name) for p, (_, point) in enumerate(system.points, start=1) if point.loads]:
        note = (
            "FP_P_i and MP_P_i are inertial components of a force at point P (N) and of a moment on its body "
            f"(N m). Loaded: {_numbered(loaded)}."
        )
        yield Section("Loads on points", note)


def _numbered(names: Iterable[tuple[int, str]]) -> str:
    return ", ".join(f"{number} ({name})" for number, name in names)


def force_elements(system: System) -> Iterator[Section]:
    """What acts by a law of its own."""
    if system.force_elements:
        words = "; ".join(element.words for element in system.force_elements)
        yield Section("Force elements", f"{words}.")
