"""`modelDescription.xml`: variables of an FMU, their units, what depends on what, as attributes of XML."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any
from xml.sax.saxutils import quoteattr

from kanegen import __version__
from kanegen.artifacts.fmi.calls import NONE, Differentiated
from kanegen.artifacts.fmi.layout import Layout
from kanegen.artifacts.fmi.structure import Structure
from kanegen.artifacts.fmi.units import exponents
from kanegen.artifacts.fmi.variables import Variable

_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that no text in XML may hold."""

_ME, _CS = "ModelExchange", "CoSimulation"


@dataclass(frozen=True)
class Description:
    """What `modelDescription.xml` says.

    Attributes:
        layout: The numbers of an instance.
        structure: What depends on what.
        differentiated: For each computed array where its derivatives are.
        token: The text by which the file and the code are known to belong together.
        version: Version of FMI, 2 or 3.
    """

    layout: Layout
    structure: Structure
    differentiated: Sequence[Differentiated]
    token: str
    version: int

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """The variables; those of FMI 2.0 are single numbers, and the time is one only where it matters."""
        found = self.layout.variables
        if self.version == 3:
            return found
        time, *others = found
        matters = any(self.structure.knowns(one, [time]) for one in others)
        return tuple(one for each in ([time] * matters + others) for one in each.elements())

    def context(self) -> Mapping[str, Any]:
        """Return the variables of the template."""
        outputs = [one for one in self.variables if one.causality == "output"]
        rates = [one for one in self.variables if one.state is not None]
        first = [one for one in self.variables if one.start is None and one.causality in ("output", "local")]
        return {
            "attributes": self._attributes(),
            "interface_attributes": {_ME: self._model_exchange(), _CS: self._co_simulation()},
            "units": [
                {"name": attributes(name=unit), "exponents": attributes(**exponents(unit))}
                for unit in sorted({one.unit for one in self.variables if one.unit})
            ],
            "variables": [self._variable(one) for one in self.variables],
            "outputs": [self._unknown(one, self._knowns) for one in outputs],
            "derivatives": [self._unknown(one, self._knowns) for one in rates],
            "initial_unknowns": [self._unknown(one, self._initial_knowns) for one in first],
        }

    @property
    def has_derivatives(self) -> bool:
        """Whether all outputs have derivatives by all states and inputs on which they depend."""
        inside = {name for name in self.layout.inputs if name not in ("t", "parameters")}
        columns = (column for one in self.differentiated for column in one.columns)
        return all(column.column != NONE for column in columns if column.array in inside)

    @cached_property
    def _knowns(self) -> list[Variable]:
        """The variables on which others depend at any time; FMI 2.0 does not count parameters among them."""
        kinds = ("input", "independent", *(("parameter",) if self.version == 3 else ()))
        return [one for one in self.variables if one.causality in kinds or one.is_state]

    @cached_property
    def _initial_knowns(self) -> list[Variable]:
        """The variables on which others depend when a simulation begins."""
        kinds = ("input", "independent", "parameter")
        return [one for one in self.variables if one.causality in kinds or one.is_state]

    @cached_property
    def _indices(self) -> dict[int, int]:
        """What names a variable in the structure, by its place: an index from 1, or its value reference."""
        if self.version == 3:
            return {one.first: one.first for one in self.variables}
        return {one.first: index for index, one in enumerate(self.variables, start=1)}

    def _attributes(self) -> str:
        """Return the attributes of the root element."""
        model = self.layout.source.model
        token = {2: "guid", 3: "instantiationToken"}[self.version]
        return attributes(
            fmiVersion={2: "2.0", 3: "3.0"}[self.version],
            modelName=model.shown,
            **{token: self.token},
            description=f"Kane's equations of motion of {model.shown}. Co-simulation: {self.layout.method}.",
            license="Generated code belongs to whoever generated it. The headers of FMI: 2-clause BSD.",
            generationTool=f"kanegen {__version__}",
            variableNamingConvention="structured",
            numberOfEventIndicators=0 if self.version == 2 else None,
        )

    def _model_exchange(self) -> str:
        """Return the attributes of model exchange."""
        steps = {"completedIntegratorStepNotNeeded": True} if self.version == 2 else {}
        return attributes(**self._common(), **steps)

    def _co_simulation(self) -> str:
        """Return the attributes of co-simulation."""
        return attributes(**self._common(), canHandleVariableCommunicationStepSize=True)

    def _common(self) -> dict[str, Any]:
        """Return the attributes that model exchange and co-simulation share."""
        name, derivatives = self.layout.source.model.name, self.has_derivatives
        if self.version == 2:
            return {
                "modelIdentifier": name,
                "canGetAndSetFMUstate": True,
                "canSerializeFMUstate": True,
                "providesDirectionalDerivative": derivatives,
            }
        return {
            "modelIdentifier": name,
            "canGetAndSetFMUState": True,
            "canSerializeFMUState": True,
            "providesDirectionalDerivatives": derivatives,
            "providesAdjointDerivatives": derivatives,
        }

    def _variable(self, one: Variable) -> Mapping[str, Any]:
        """Return the attributes of a variable and of its type, and the lengths of its axes."""
        is_derivative = one.state is not None
        derivative = self._indices[one.state] if one.state is not None else None
        return {
            "attributes": attributes(
                name=one.name,
                valueReference=one.first,
                description=one.description,
                causality=one.causality,
                variability=one.variability,
                initial="exact" if one.is_state else None,
            ),
            "type_attributes": attributes(
                unit=one.unit or None,
                min=_number(one.minimum),
                max=_number(one.maximum),
                start=None if one.start is None else " ".join([repr(one.start)] * one.size),
                derivative=derivative if is_derivative else None,
            ),
            "lengths": one.shape,
        }

    def _unknown(self, one: Variable, knowns: Sequence[Variable]) -> str:
        """Return the attributes of a variable among those of the structure."""
        found = [self._indices[known.first] for known in self.structure.knowns(one, knowns)]
        name = {2: "index", 3: "valueReference"}[self.version]
        return attributes(**{name: self._indices[one.first]}, dependencies=" ".join(map(str, found)))


def attributes(**values: object) -> str:
    """Return attributes of an element of XML, a blank before each, without those that are None.

    Example:
        attributes(name="m/s", s=-1)  # ' name="m/s" s="-1"'
    """
    return "".join(f" {name}={_quoted(value)}" for name, value in values.items() if value is not None)


def _quoted(value: object) -> str:
    """Return a value between quotation marks."""
    if isinstance(value, bool):
        return '"true"' if value else '"false"'
    return quoteattr(_NO_XML.sub("?", str(value)))


def _number(value: float) -> str | None:
    """Return a number, None for an infinite one."""
    return repr(float(value)) if math.isfinite(value) else None


def in_lines(values: Iterable[object], count: int = 20) -> list[str]:
    """Return values with commas between them, some in a line."""
    every = [str(value) for value in values]
    lines = [", ".join(every[first : first + count]) for first in range(0, len(every), count)]
    return [f"{line}," for line in lines[:-1]] + lines[-1:]
