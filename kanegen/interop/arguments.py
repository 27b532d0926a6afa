"""Arguments of functions for other programs: by place and by name, as the methods of `Library` take them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError, quoted
from kanegen.library import Library
from kanegen.library.native.calls import arguments_of
from kanegen.model.arguments import ARGUMENTS, LOADS
from kanegen.program.ir import PARAMETERS


@dataclass(frozen=True)
class ArgumentNames:
    """Names of the arguments of a function.

    Attributes:
        function: Name of the function.
        system: Name of the system.
        positional: Arguments that may be passed without their name, in order.
        named: Arguments that are passed by name.
        read: Arguments that the function reads in this system.

    Example:
        names = ArgumentNames.of("forward_dynamics", library, ("x", "y", "tau"))
        names.bound((x, y), {"tau": tau})   # {"x": x, "y": y, "tau": tau}
    """

    function: str
    system: str
    positional: tuple[str, ...]
    named: tuple[str, ...]
    read: tuple[str, ...]

    @classmethod
    def of(cls, function: str, library: Library, read: Sequence[str]) -> ArgumentNames:
        """Return the names of the arguments of a function of a library.

        Args:
            function: Name of an output, or of a function that makes one step.
            library: The library.
            read: Arguments that the function reads in this system.
        """
        named = (*library.further_inputs, *((PARAMETERS,) if library.parameters else ()))
        return cls(function, library.name, arguments_of(function), named, tuple(read))

    def bound(self, values: Sequence[Any], named: Mapping[str, Any]) -> dict[str, Any]:
        """Return the values by name, but for those that are None.

        Args:
            values: Values of `positional`, which may end early.
            named: Further values by name.

        Raises:
            ArrayError: If there are too many, one is passed twice, there is no such argument, or it is a load
                that nothing in the system takes.
        """
        order = self.positional
        if len(values) > len(order):
            raise ArrayError(
                f"{self.function}: {len(values)} arguments without a name; there are {', '.join(order)}."
            )
        given = dict(zip(order[: len(values)], values, strict=True))
        for name, value in named.items():
            if name in given:
                raise ArrayError(f"{name}: passed twice, by its place and by its name.")
            if name not in order and name not in self.named:
                raise self._unknown(name)
            given[name] = value
        given = {name: value for name, value in given.items() if value is not None}
        for name in given:
            if name in LOADS and name not in self.read:
                raise ArrayError(f"{name}: nothing in system {quoted(self.system)} takes it. Leave it out.")
        return given

    def _unknown(self, name: str) -> ArrayError:
        """Return the error that there is no argument of a name."""
        known = (*self.positional, *self.named)
        if name in ARGUMENTS or name == PARAMETERS:
            return ArrayError(
                f"{name}: {self.function} of system {quoted(self.system)} does not depend on it. Its "
                f"arguments are {', '.join(known)}."
            )
        return ArrayError(f"{name}: there is no such argument. {did_you_mean(name, known)}")
