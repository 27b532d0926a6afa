"""Compiled code with values of its parameters: what it is, and how it is called."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self, Unpack

from numpy.typing import ArrayLike

from kanegen.c import Source
from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError, ModelError, OptionError
from kanegen.library.evaluation import Evaluation
from kanegen.library.native.calls import Call, Native
from kanegen.model.arguments import ARGUMENTS, FURTHER, Floats, Values
from kanegen.model.load_arguments import Given
from kanegen.model.numbers import finite
from kanegen.program.ir import EVALUATE
from kanegen.program.precision import precision_named


class Compiled:
    """What every kind of output needs of a library; see `Library`."""

    def __init__(self, native: Native, parameters: Mapping[str, float]) -> None:
        self._native = native
        self._parameters = dict(parameters)
        self._constants = native.constants(self._parameters)
        model = native.source.model
        self._takes_loads = model.takes_loads
        inputs = {array.name for function in native.source.functions for array in function.inputs}
        self._further = tuple(name for name in FURTHER if name in inputs)
        self._together = native.calls.get(EVALUATE) or native.calls[self.outputs[0]]

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}: {self.n} freedoms, {', '.join(self.outputs)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _reopen, (type(self), self.source, self._native.path, self._parameters)

    @property
    def source(self) -> Source:
        """What was compiled."""
        return self._native.source

    @property
    def path(self) -> Path:
        """File of the shared library."""
        return self._native.path

    @property
    def name(self) -> str:
        """Name of the system."""
        return self.source.model.name

    @property
    def n(self) -> int:
        """Number of freedoms."""
        return len(self.freedom_names)

    @property
    def freedom_names(self) -> tuple[str, ...]:
        """n names of the freedoms, in the order of {y}."""
        return self.source.model.freedom_names

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """m names in the order of {x}: of the freedoms, or of the four elements of a quaternion."""
        return self.source.model.coordinate_names

    @property
    def speed_names(self) -> tuple[str, ...]:
        """n names in the order of {y}: of the coordinate whose rate it is, or of the component."""
        return self.source.model.speed_names or self.freedom_names

    @property
    def point_names(self) -> tuple[str, ...]:
        """Names of the points, in the order of the rows of outputs about them."""
        return tuple(name for name, _ in self.source.model.points)

    @property
    def pose_names(self) -> tuple[str, ...]:
        """Names of the bodies of `body_poses`, in the order of its rows."""
        return self.source.model.poses

    @property
    def reaction_names(self) -> tuple[str, ...]:
        """Names of the locked directions of `reaction_loads`, in its order."""
        return tuple(name for name, _ in self.source.model.reactions)

    @property
    def prescribed_names(self) -> tuple[str, ...]:
        """p names of the prescribed freedoms, in the order of the columns of `prescribed`."""
        return self.source.model.prescribed_names

    @property
    def outputs(self) -> tuple[str, ...]:
        """What it can compute."""
        return self.source.outputs

    @property
    def further_inputs(self) -> tuple[str, ...]:
        """Names of the inputs that are passed by name, because only some systems have them."""
        return self._further

    @property
    def precision(self) -> str:
        """The arithmetic of its C: "double", "float", "long double" or "double-double"."""
        return self.source.precision

    @property
    def storage(self) -> str:
        """What its arrays hold: "double" is float64 in NumPy, "float" float32, "long double" longdouble.

        For "double-double" they are float64 with a last axis of 2 behind the documented ones: every number is
        the exact sum of two doubles, of which the first is that sum rounded. Arguments have that axis too.
        """
        return self.source.storage

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the run-time parameters; a copy."""
        return dict(self._parameters)

    def with_parameters(self, values: Mapping[str, float]) -> Self:
        """The same library with other values of some parameters; the others stay as they are.

        Args:
            values: By name of the parameter, in the unit of the place where it stands. Only the names and
                that they are finite is checked; `System.with_parameters` also checks what they mean.

        Raises:
            ModelError: If a name is unknown, or a value is not a finite number of the library's precision.
        """
        for name in values:
            if name not in self._parameters:
                raise ModelError(f"unknown parameter {name!r}. {did_you_mean(name, self._parameters)}")
        checked = {name: finite(value, f"parameter {name!r}") for name, value in values.items()}
        for name, value in checked.items():
            precision_named(self.precision).rounded(value, f"parameter {name!r}")
        return type(self)(self._native, {**self._parameters, **checked})

    def evaluate(
        self,
        x: ArrayLike,
        y: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        *,
        ydot: ArrayLike | None = None,
        tau: ArrayLike | None = None,
        **given: Unpack[Given],
    ) -> Evaluation:
        """Every output at once, which costs less than one after the other.

        What is shared may be summed in another way than by the function of one output alone, so the two can
        differ by rounding.

        Args:
            x: As in `forcing`.
            y: As in `forcing`; needed where an output depends on it.
            force: As in `forcing`.
            torque: As in `forcing`.
            ydot: As in `inverse_dynamics`; needed where that is among the outputs.
            tau: As in `forward_dynamics`.
            given: As in `forcing`.

        Returns:
            The outputs in order, each also an attribute of its name.

        Raises:
            ArrayError, SingularError: As the functions of the outputs.
        """
        values = (x, y, ydot, tau, force, torque)
        return Evaluation(self.outputs, self._run(self._together, values, given))

    def _call(self, name: str) -> Call:
        call = self._native.calls.get(name)
        if call is None:
            raise OptionError(
                f"system {self.name!r} was built without the output {name!r}. It has "
                f"{', '.join(self.outputs)}; ask for more with outputs=(...)."
            )
        return call

    def _run(self, call: Call, values: Values, given: Given) -> list[Floats]:
        """Call C.

        Args:
            call: The function.
            values: The first of `ARGUMENTS`, none where there are no more.
            given: The others, by name.

        Raises:
            ArrayError: If a value does not fit, is missing, or is for nothing in this system.
        """
        loads = values[4:]
        if loads and not self._takes_loads and not (loads[0] is None and loads[1] is None):
            name = "torque" if loads[0] is None else "force"
            raise ArrayError(
                f"{name}: no body of system {self.name!r} takes loads. Say which do in the model's loads."
            )
        if given or self._further:
            values = self._completed(values, given)
        return call(self._constants, values)

    def _completed(self, values: Values, given: Given) -> Values:
        """One for each of `ARGUMENTS`."""
        for name in given:
            if name not in FURTHER:
                raise ArrayError(f"{name}: there is no such argument. {did_you_mean(name, ARGUMENTS)}")
            if name not in self._further:
                raise ArrayError(f"{name}: no output of system {self.name!r} depends on it. Leave it out.")
        absent = len(ARGUMENTS) - len(FURTHER) - len(values)
        return (*values, *(None,) * absent, *map(given.get, FURTHER))


def _reopen(kind: type[Compiled], source: Source, path: Path, parameters: Mapping[str, float]) -> Compiled:
    return kind(Native(source, path), parameters)
