"""Compiled code with values of its run-time parameters: names and sizes, and how every output is called."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Self, TypeVar, Unpack

from numpy.typing import ArrayLike

from kanegen.c import Source
from kanegen.c.interface import PREPARE
from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError, ModelError, OptionError, counted, quoted
from kanegen.library.library_html import library_html
from kanegen.library.native import processor
from kanegen.library.native.build import Recipe
from kanegen.library.native.calls import arguments_of
from kanegen.library.native.constants import Constants
from kanegen.library.native.loaded import NativeLibrary
from kanegen.library.native.status import OnStatus, StatusReport, checked_on_status, report
from kanegen.library.results import Evaluation
from kanegen.model import validation
from kanegen.model.arguments import ARGUMENTS, MODEL_DEPENDENT, Floats, NamedInputs, Values
from kanegen.model.numbers import finite
from kanegen.model.parameter_sets import ParameterSets, parameter_sets
from kanegen.program.ir import EVALUATE, PARAMETERS
from kanegen.program.precision import precision_named

Found = TypeVar("Found")


class CompiledModel:
    """Compiled functions with values of their parameters, called by name; `Library` adds a method per output.

    The table of outputs, `recursion.outputs.OUTPUTS`, says which arguments each output has and in which order
    they are passed to `_run`.
    """

    def __init__(
        self,
        native: NativeLibrary,
        parameters: Mapping[str, float],
        on_status: OnStatus = "warn",
        constants: Constants | None = None,
    ) -> None:
        """Combine a loaded library with values of its run-time parameters.

        Args:
            native: The loaded library.
            parameters: Values by name.
            on_status: What to do where a result is missing, not finite or not accurate.
            constants: Prepared constants for these values; by default they are computed.
        """
        self._native = native
        self._parameters = dict(parameters)
        self._on_status = checked_on_status(on_status)
        if constants is None:
            constants = native.constants(list(self._parameters.values()), on_status)
        self._constants = constants
        self._calls = native.calls
        self._named_inputs = native.named_inputs

    def __repr__(self) -> str:
        freedoms = counted(self.n, "freedom")
        return f"<{type(self).__name__} {self.name}: {freedoms}, {', '.join(self.outputs)}>"

    def _repr_html_(self) -> str:
        """What is computed and how it is called, and the values of the parameters, for a notebook."""
        named = {"x": self.coordinate_names, "y": self.speed_names, "prescribed": self.prescribed_names}
        return library_html(self.source, self._parameters, named)

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how `pickle` makes the library anew: from the same file, or from the source, if need be."""
        recipe, path = self._native.recipe, self._native.path
        place = (path.parent.name, path.name, processor.fingerprint())
        return _reopen, (type(self), recipe, place, self._parameters, self._on_status)

    @property
    def source(self) -> Source:
        """The generated C that was compiled."""
        return self._native.source

    @property
    def recipe(self) -> Recipe:
        """What was compiled and how."""
        return self._native.recipe

    @property
    def path(self) -> Path:
        """Path of the shared library."""
        return self._native.path

    @property
    def name(self) -> str:
        """Name of the system."""
        return self.source.model.shown

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
        """m names in the order of {x}: those of the freedoms, or of the four elements of a quaternion."""
        return self.source.model.coordinate_names

    @property
    def speed_names(self) -> tuple[str, ...]:
        """n names in the order of {y}: the coordinate whose rate the speed is, or a velocity component."""
        return self.source.model.speed_names or self.freedom_names

    @property
    def point_names(self) -> tuple[str, ...]:
        """P names of the points, in the order of the rows of `point_positions` and similar outputs."""
        return tuple(name for name, _ in self.source.model.points)

    @property
    def pose_names(self) -> tuple[str, ...]:
        """Names of the frames in outputs about frames, in the order of their rows."""
        return self.source.model.poses

    @property
    def reaction_names(self) -> tuple[str, ...]:
        """R names of the loads of `reaction_loads`, in the order of its entries."""
        return tuple(name for name, *_ in self.source.model.reactions)

    @property
    def contact_names(self) -> tuple[str, ...]:
        """r names of the held directions of contacts, in the order of the loads of `contact_forces`."""
        return tuple(name for name, _ in self.source.model.contact_rows)

    @property
    def prescribed_names(self) -> tuple[str, ...]:
        """p names of the prescribed freedoms, in the order of the columns of the input `prescribed`."""
        return self.source.model.prescribed_names

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs that were compiled; each is also a method."""
        return (*self.source.outputs, *self.source.integrators)

    @property
    def further_inputs(self) -> tuple[str, ...]:
        """Names of the inputs that are passed by name, because only some systems have them."""
        return self._named_inputs

    @property
    def precision(self) -> str:
        """The arithmetic of the C code: "double", "float", "long double" or "double-double"."""
        return self.source.precision

    @property
    def storage(self) -> str:
        """The numbers in its arrays: "double" is float64 in NumPy, "float" float32, "long double" longdouble.

        Arrays in "double-double" are of float64 and have a last axis of 2 behind the documented ones: each
        number is the exact sum of two doubles, the first of which is that sum rounded. Arguments have that
        axis too.
        """
        return self.source.storage

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the run-time parameters by name, as a copy."""
        return dict(self._parameters)

    def with_parameters(self, values: Mapping[str, float]) -> Self:
        """Return the same library with other values of some run-time parameters.

        Nothing is compiled anew. Only the names are checked, and that the values are finite;
        `System.with_parameters` also checks whether the model is usable with them.

        Args:
            values: New values by name of the parameter, in the unit of the place where it stands.

        Raises:
            ModelError: If a name is unknown, or a value is not a finite number of the library's precision.

        Example:
            heavy = library.with_parameters({"m1": 3.0})
        """
        for name in validation.table(values, "parameters", '{"payload": 2.5}'):
            if name not in self._parameters:
                raise ModelError(f"unknown parameter {quoted(name)}. {did_you_mean(name, self._parameters)}")
        checked = {name: finite(value, f"parameter {quoted(name)}") for name, value in values.items()}
        for name, value in checked.items():
            precision_named(self.precision).rounded(value, f"parameter {quoted(name)}")
        parameters = {**self._parameters, **checked}
        constants = self._native.constants(list(parameters.values()), self._on_status, changed=checked)
        return type(self)(self._native, parameters, self._on_status, constants)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """P names of the run-time parameters, in the order of the argument `parameters` of every method."""
        return tuple(self._parameters)

    @property
    def on_status(self) -> OnStatus:
        """What the library does where a result is missing or not finite; see `with_on_status`."""
        return self._on_status

    def with_on_status(self, on_status: OnStatus) -> Self:
        """Return the same library with another rule for what is missing, not finite or not accurate.

        One rule holds for all functions, for one state and for batches. A result is *missing* where it does
        not exist, such as accelerations where [A] is singular; its numbers are then NaN. It is *not finite*
        where a number in it is infinite or NaN, such as with such an input, or where a force element divides
        by 0. It *may be inaccurate* where forward dynamics says so. A report names the function, the first
        state in a batch, and the freedom or the element of the result.

        Args:
            on_status: "warn" gives one `KanegenWarning` for a call, at the line that made it; but a call for
                one state whose result is missing raises, since there is nothing to return. "raise" raises in
                all these cases. "ignore" says nothing. A function is called with every `StatusReport`.

        Raises:
            OptionError: If `on_status` is none of these.

        Example:
            strict = library.with_on_status("raise")
        """
        return type(self)(self._native, self._parameters, on_status, self._constants)

    def evaluate(
        self,
        x: ArrayLike,
        y: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        *,
        ydot: ArrayLike | None = None,
        tau: ArrayLike | None = None,
        weights: ArrayLike | None = None,
        direction: ArrayLike | None = None,
        state_direction: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Evaluation:
        """Compute all outputs in one call, which costs less than separate calls.

        The shared intermediates may be summed in another order than in the function of one output, so the
        two may differ by rounding.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s; needed if an output depends on them.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2; needed if an output depends on
                them.
            tau: Generalized forces, as in `forward_dynamics`.
            weights: (n,) or (B, n) weights, as in `forward_dynamics_vjp`; needed for such outputs.
            direction: Direction of the variables, as in `forward_dynamics_jvp`; needed for such outputs.
            state_direction: Direction of the variables of {f}, as in `forcing_jvp`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            The outputs in order, each also an attribute of its name.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or is missing.
            StatusError: See `with_on_status`.

        Example:
            A, f = kg.build(system).evaluate(x, y)
        """
        products = weights, direction, state_direction
        results = self._run(EVALUATE, (x, y, ydot, *products, tau, force, torque), inputs)
        return Evaluation(self.source.outputs, results)

    def _run(self, name: str, values: Values, inputs: NamedInputs) -> list[Floats]:
        """Call the C function of an output.

        Args:
            name: Name of the output, or `EVALUATE` for all.
            values: Arguments of the function in the order of the table of outputs, None for an absent one.
            inputs: The inputs that only some systems have, by name.

        Returns:
            An array for each output of the function.

        Raises:
            OptionError: If the function was not generated.
            ArrayError: If an argument does not fit, is missing, or is not read by anything in this system.
            StatusError: See `with_on_status`.
        """
        call = self._calls.get(name)
        if call is None:
            raise self._absent(name)
        parameters = inputs.get("parameters")
        if inputs or self._named_inputs:
            values = (*values, *self._in_order(name, inputs))
        if parameters is None:
            return call(self._constants, values, self._on_status)
        return self._with_sets(call, parameters, values)

    def _with_sets(
        self, call: Callable[[Constants, Values, OnStatus], Found], parameters: ParameterSets, values: Values
    ) -> Found:
        """Call a C function with other parameters: one set, or a set for each state of the batch.

        What is not finite in `prepare` is reported only where the results do not show it.

        Raises:
            ArrayError, ModelError, OptionError: If the parameters do not fit.
            StatusError: See `with_on_status`.
        """
        if not self._parameters:
            raise ArrayError(f"parameters: system {quoted(self.name)} has no run-time parameters.")
        rule, found = self._on_status, list[StatusReport]()
        sets = parameter_sets(parameters, self._parameters, self._native.parameter_type)
        constants = self._native.constants(sets, "ignore" if rule == "ignore" else found.append)
        reported = len(found)
        results = call(constants, values, "ignore" if rule == "ignore" else found.append)
        for one in found[reported:] or found[:reported]:
            report(one, rule)
        return results

    def _absent(self, name: str) -> OptionError:
        """Return the error that says that the function of an output was not generated."""
        if name in (*self.outputs, EVALUATE):
            functions = ", ".join(function for function in self._calls if function != PREPARE)
            return OptionError(
                f"system {quoted(self.name)} was built without the function {quoted(name)}. It has "
                f"{functions}; ask for more with functions=(...)."
            )
        return OptionError(
            f"system {quoted(self.name)} was built without the output {quoted(name)}. It has "
            f"{', '.join(self.outputs)}; ask for more with outputs=(...)."
        )

    def _in_order(self, function: str, inputs: NamedInputs) -> Values:
        """Return the inputs that are passed by name in the order of `further_inputs`, None for an absent one.

        Args:
            function: Name of the function that is called.
            inputs: The inputs by name.

        Raises:
            ArrayError: If there is no input of a name, the function does not take it, or no output depends on
                it.
        """
        for name in inputs:
            if name == PARAMETERS:
                continue
            if name in ARGUMENTS and name not in MODEL_DEPENDENT:
                taken = ", ".join((*arguments_of(function), *self._named_inputs))
                raise ArrayError(f"{name}: {function} does not depend on it. Its arguments are {taken}.")
            if name not in MODEL_DEPENDENT:
                known = (*arguments_of(function), *self._named_inputs)
                raise ArrayError(f"{name}: there is no such argument. {did_you_mean(name, known)}")
            if name not in self._named_inputs:
                raise ArrayError(
                    f"{name}: no output of system {quoted(self.name)} depends on it. Leave it out."
                )
        return tuple(map(inputs.get, self._named_inputs))


def _reopen(
    kind: type[CompiledModel],
    recipe: Recipe,
    place: tuple[str, str, str],
    parameters: Mapping[str, float],
    on_status: OnStatus,
) -> CompiledModel:
    """Return a library that another process has pickled."""
    return kind(NativeLibrary.found(recipe, *place), parameters, on_status)
