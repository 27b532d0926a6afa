"""`SystemParametrisation`: the same system with other numbers, or with parameters in place of numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.arguments import state
from kanegen.model.description import SystemDescription
from kanegen.model.numbers import Number, Parameter, listed, with_parameters_changed
from kanegen.model.parameter_sets import ParameterSets, parameter_sets, refusals
from kanegen.model.same_tree import parameters_for, with_parameters_where_different
from kanegen.model.symbolic import with_symbols
from kanegen.model.system_fields import SystemFields
from kanegen.model.system_numbers import mapped_numbers


@dataclass(frozen=True)
class SystemParametrisation(SystemDescription):
    """The methods of a `System` about its numbers and its run-time parameters."""

    def with_parameters(self, values: Mapping[str, float]) -> Self:
        """Return the same system with other default values of its parameters.

        Raises:
            ModelError: If a name is unknown or a value makes the model unusable.

        Example:
            system.with_parameters({"payload": 2.5})
        """
        known = [parameter.name for parameter in self.parameters]
        for name in validation.table(values, "parameters", '{"payload": 2.5}'):
            if name not in known:
                raise ModelError(f"unknown parameter {quoted(name)}. {did_you_mean(name, known)}")
        if not values:
            return self

        def change(value: Number) -> Number:
            return with_parameters_changed(
                value, lambda one: Parameter(one.name, values[one.name]) if one.name in values else one
            )

        return self.map_numbers(change)

    def unusable_parameters(self, parameters: ParameterSets) -> dict[int, str]:
        """Return why no model has the parameters of a set, such as a negative mass, by row of the set.

        A library computes with any numbers. A sweep asks here beforehand which of its samples are no bodies.

        Args:
            parameters: (B, P) values in the order of `parameters`, or numbers and (B,) values by name.

        Returns:
            For each row that `with_parameters` refuses its message; {} where all are usable.

        Raises:
            ModelError: If a name is unknown.
            ArrayError: If the values have another shape or type.

        Example:
            system.unusable_parameters({"payload": [1.0, -1.0]})  # {1: "mass payload = -1.0 kg ..."}
        """
        usual = {parameter.name: parameter.value for parameter in self.parameters}
        sets = state("parameters", parameter_sets(parameters, usual), (len(usual),), np.dtype(float))
        return refusals(self, dict(zip(usual, np.atleast_2d(sets).T, strict=True)), self.with_parameters)

    def symbolic(self, keep_zeros: bool = True) -> Self:
        """Return the same system with symbols for the numbers of its bodies, as the notes have them.

        The symbols are parameters: masses `m_K`, mass centres `r_K_i`, joint positions `q_K_i` and entries of
        inertia `I_K_ij` of body K, and gravity, `g`, or `g_1` to `g_3` where it is along no axis. Their
        default values are the numbers. Parameters and expressions of parameters stay as they are, and so do
        constant orientations [C_K], locked values, points, frames, motors, couplings and force elements. A
        name that is taken gets an underscore at its end.

        Args:
            keep_zeros: Whether zeros stay zero, so that the equations show what vanishes in this tree. If
                not, every body is general, as in the notes, but for joints at the inertial origin.

        Example:
            kg.derive(kg.load("models/furuta_pendulum.toml").symbolic()).closed_form().A
        """
        return replace(self, **with_symbols(self, keep_zeros))

    def with_parameters_for(self, systems: Iterable[SystemFields] | SystemFields) -> Self:
        """Return the same system with parameters for the numbers in which other systems differ from it.

        One library then computes for all of them: nothing is derived or compiled anew for another one.
        Numbers that are equal in all systems stay numbers, which cost nothing at run time. The parameters
        have the numbers of this system as default values, and names as those of `symbolic`; besides these
        there are components of gravity `g_i`, and for body K entries of the orientation [C_K] `C_K_ij`, or
        its angles `C_K_i`, locked values `locked_K_i`, armature `armature_K_i` and the position of its point
        n `point_K_n_i`. Number i of another part is `force_element_k_i`, `coupling_k_i`, `frame_k_i`,
        `rotor_k_i` or `contact_k_i`. Parameters and expressions of parameters stay as they are.

        Args:
            systems: Other systems, one or several, of the same tree: equal to this one but for the values of
                numbers, names and shapes of systems, and limits, which equations do not contain.

        Raises:
            ModelError: If a system has another tree, or differs where an expression of parameters stands
                whose value no parameters give.

        Example:
            shared = arm.with_parameters_for([lighter, longer])
            library = kg.build(shared)
            other = library.with_parameters(shared.parameters_for(longer))
        """
        several = listed(systems)
        others: list[Any] = [systems] if several is None else several
        found = replace(self, **with_parameters_where_different(self, others))
        for other in others:
            found.parameters_for(other)
        return found

    def parameters_for(self, system: SystemFields) -> dict[str, float]:
        """Return the values of the parameters, by name, with which this system is another one.

        They are what `Library.with_parameters`, the argument `parameters` of a library's methods and
        `System.with_parameters` take. Every number is compared, so that they give exactly the other system.

        Args:
            system: A system of the same tree, as in `with_parameters_for`. Its own parameters count with
                their default values.

        Raises:
            ModelError: If it has another tree, or another number where this system has no parameter; the
                message names the place.

        Example:
            shared = kg.load("arm.urdf").symbolic()
            values = shared.parameters_for(kg.load("heavier_arm.urdf"))
        """
        return parameters_for(self, system)

    def map_numbers(self, change: Callable[[Number], Number]) -> Self:
        """Return the same system with `change` applied to every number.

        Example:
            fixed = system.map_numbers(value_of)  # parameters become numbers
        """
        return replace(self, **mapped_numbers(self, change))
