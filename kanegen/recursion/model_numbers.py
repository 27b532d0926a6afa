"""Numbers of a model that are expressions of parameters: each is a definition, so formulas stay short."""

from __future__ import annotations

from kanegen.model.expression import Expression
from kanegen.model.numbers import Number, Parameter, is_fixed, value_of
from kanegen.model.system import System
from kanegen.recursion.constants import exact
from kanegen.symbolic.definitions import Definitions


def with_expressions_defined(system: System, definitions: Definitions) -> System:
    """Return a system with parameters in place of expressions of parameters, which become definitions.

    What needs no operation, such as a parameter with the other sign, stays as it is.

    Args:
        system: The system.
        definitions: Definitions that the expressions are added to.
    """
    own = {parameter.name for parameter in system.parameters}

    def defined(value: Number) -> Number:
        if is_fixed(value) or not isinstance(value, Expression):
            return value
        symbol = definitions.define_next("pe", exact(value))
        if not symbol.is_Symbol or symbol.name in own:
            return value
        return Parameter(symbol.name, value_of(value))

    if not own:
        return system
    definitions.about("Numbers of the model that are expressions of parameters")
    return system.map_numbers(defined)
