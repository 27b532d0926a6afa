"""The numbers of an instance of an FMU: inputs and states first, then what the functions of the C compute."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from kanegen.artifacts.fmi.ranges import Ranges
from kanegen.artifacts.fmi.variables import Block, Variable, parts_of
from kanegen.c.interface import PREPARE, Function
from kanegen.c.source import Source
from kanegen.c.steps import Rollout
from kanegen.model.arguments import ARGUMENTS, OF_PRODUCTS
from kanegen.model.system import System
from kanegen.program.ir import PARAMETERS, PREPARED, Array
from kanegen.recursion.outputs import DERIVATIVES, DIFFERENTIATED, EQUATIONS, INTEGRATORS, RATES

USUAL = "rollout_rk4"
"""The function that makes the steps of co-simulation where a user names no other."""

TIME = Array("t", (), "s", "the time")
"""The array of the time, which every FMU has, whether or not the system depends on it."""

STEP = Array("step", (), "s", "longest step within a communication step of co-simulation")
"""The array of the length of steps in co-simulation, a parameter of the FMU."""

STEP_LENGTH = 1e-3
"""Its value at first, s."""

SHORTEST_STEP = 1e-9
"""Its smallest value, s."""

_FORWARD, _RATES = RATES

_STATES = ("x", "y")
"""Names of the arrays of continuous states, in their order."""

_INSIDE = (PREPARED, "ydot", *OF_PRODUCTS, STEP.name)
"""Inputs of functions that are not set from outside, or not under this name."""

_ORDER = (TIME.name, *(name for name in ARGUMENTS if name not in (TIME.name, "ydot")), PARAMETERS, STEP.name)
"""The order of the arrays that are set from outside."""

_CAUSALITY = {TIME.name: "independent", PARAMETERS: "parameter", STEP.name: "parameter", "xdot": "local"}
_VARIABILITY = {PARAMETERS: "tunable", STEP.name: "fixed"}


@dataclass(frozen=True)
class Slopes:
    """The derivatives of an array, among those that an instance keeps.

    Attributes:
        function: The function of the C that computes them.
        first: Place of their first number among all derivatives of an instance.
        columns: The columns of each array with respect to which they are.
    """

    function: Function
    first: int
    columns: Mapping[str, slice]


@dataclass(frozen=True)
class Layout:
    """The numbers of an instance, and the functions of the C that compute some of them.

    Attributes:
        source: The generated C.
        system: The system that it computes.
    """

    source: Source
    system: System

    @cached_property
    def functions(self) -> dict[str, Function]:
        """The functions of outputs by name."""
        return {function.name: function for function in self.source.functions}

    @property
    def rollout(self) -> Rollout:
        """The function that makes the steps of co-simulation: one that a user asked for, or else `USUAL`."""
        every = self.source.rollouts
        return next((one for one in every if one.name != USUAL), every[0])

    @property
    def method(self) -> str:
        """Name and order of the method of these steps in a sentence."""
        method = INTEGRATORS[self.rollout.name]
        return f"{method.title.rstrip(',')} of order {method.order}"

    @cached_property
    def inputs(self) -> dict[str, Block]:
        """The arrays that are set from outside, by name in C."""
        arrays = {TIME.name: TIME}
        for function in (*self.source.functions, *(one.step for one in self.source.rollouts)):
            arrays |= {array.name: array for array in function.inputs if array.name not in _INSIDE}
        arrays[STEP.name] = STEP
        return self._placed([("", arrays[name]) for name in _ORDER if name in arrays], 0)

    @cached_property
    def computed(self) -> dict[str, Block]:
        """The arrays that functions of the C compute from the others, by name in C; {xdot} and {ydot} first.

        [A] and {f}, which belong to every source, are none of them.
        """
        first = [(_RATES, self._rates), (_FORWARD, self.functions[_FORWARD].outputs[0])]
        others = [
            (name, self.functions[name].outputs[0])
            for name in self.source.outputs
            if name not in (*RATES, *EQUATIONS, *DIFFERENTIATED) and name in self.functions
        ]
        return self._placed([*first, *others], self.settable)

    @cached_property
    def slopes(self) -> dict[str, Slopes]:
        """The derivatives of computed arrays that the C has, by name of the array."""
        found, first = {}, 0
        for name, block in self.computed.items():
            function = self.functions.get(f"{block.output}_derivatives")
            if function is not None:
                columns = DERIVATIVES[function.name].columns_of(self.system)
                found[name] = Slopes(function, first, columns)
                first += function.outputs[0].size
        return found

    @property
    def settable(self) -> int:
        """How many numbers are set from outside; the computed ones follow."""
        return max(block.places.stop for block in self.inputs.values())

    @property
    def size(self) -> int:
        """How many numbers there are."""
        return max(block.places.stop for block in self.computed.values())

    @cached_property
    def blocks(self) -> dict[str, Block]:
        """All arrays by name in C."""
        return {**self.inputs, **self.computed}

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """The variables, the time first."""
        return tuple(variable for block in self.blocks.values() for variable in self._variables(block))

    @property
    def has_prepare(self) -> bool:
        """Whether there are run-time parameters, on which prepared constants depend."""
        return PREPARE in self.functions

    @property
    def _rates(self) -> Array:
        """The array of {xdot}, which has a function only where it is not {y}."""
        if _RATES in self.functions:
            return self.functions[_RATES].outputs[0]
        y = next(array for array in self.functions[_FORWARD].inputs if array.name == "y")
        return Array("xdot", y.shape, y.unit, "{xdot} = {y}, the rates of the coordinates, Eq. (45)")

    def _placed(self, arrays: list[tuple[str, Array]], first: int) -> dict[str, Block]:
        """Return blocks one after the other, from the place `first`."""
        found: dict[str, Block] = {}
        for output, array in arrays:
            parts = parts_of(array, self.source.model, output)
            found[array.name] = Block(array, first, output, parts)
            first += array.size
        return found

    @cached_property
    def _ranges(self) -> Ranges:
        """Start values and ranges of all that is set from outside."""
        return Ranges.of(self.system)

    def _variables(self, block: Block) -> Iterator[Variable]:
        """Yield the variables of an array."""
        for part in block.parts:
            start, minimum, maximum = self._range(block, part.first)
            yield Variable(
                name=_name(block.name, part.label),
                first=block.first + part.first,
                shape=part.shape,
                unit=part.unit,
                description=block.array.doc,
                causality=_causality(block),
                variability=_VARIABILITY.get(block.name, "continuous"),
                start=None if block.output or block.name == TIME.name else start,
                minimum=minimum,
                maximum=maximum,
                state=self._state_of(block, part.first),
                is_state=block.name in _STATES,
            )

    def _range(self, block: Block, place: int) -> tuple[float, float, float]:
        """Return start value, smallest and largest value of an element of an array."""
        if block.name == STEP.name:
            return STEP_LENGTH, SHORTEST_STEP, math.inf
        return self._ranges.of_element(block.name, place)

    def _state_of(self, block: Block, place: int) -> int | None:
        """Return the place of the state whose derivative is at a place of an array, None if it is none."""
        of = {"xdot": "x", "acceleration": "y"}.get(block.name)
        return None if of is None else self.inputs[of].first + place


def _name(array: str, label: str) -> str:
    """Return the name of the variable of a part of an array; rates of states are named as derivatives."""
    if array == TIME.name:
        return "time"
    of = {"xdot": "x", "acceleration": "y"}.get(array)
    return f"der({of}.{label})" if of else ".".join(filter(None, (array, label)))


def _causality(block: Block) -> str:
    """Return the causality of the variables of an array."""
    return _CAUSALITY.get(block.name, "output" if block.output or block.name in _STATES else "input")
