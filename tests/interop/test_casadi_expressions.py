"""Programs as expressions of CasADi against compiled functions; CasADi's derivatives against kanegen's."""

import numpy as np
import pytest

from kanegen.errors import OptionError
from kanegen.interop import casadi
from tests.support.casadi_functions import SYSTEMS, made
from tests.support.cases import slow_except
from tests.support.random_trees import everything


@pytest.mark.parametrize("case", slow_except(SYSTEMS, "loads", "quaternion"))
def test_expressions_have_the_values_and_derivatives_of_the_c(case):
    """CasADi differentiates the instructions themselves, by its own rules."""
    system, library, functions = made(case)
    require_equal_expressions(library, functions, values(system))


@pytest.mark.slow
@pytest.mark.parametrize("seed", slow_except(range(8), *range(3)))
def test_expressions_of_random_trees(seed):
    system = everything(seed, 2)
    functions = {name: casadi.function(system, name) for name in ("ode", "inverse_dynamics")}
    require_equal_expressions(system, functions, values(system))


def values(system):
    return np.array([parameter.value for parameter in system.parameters])


def require_equal_expressions(model, functions, defaults):
    for name in ("ode", "inverse_dynamics"):
        compiled, expression = functions[name], casadi.expression(model, name)
        rng = np.random.default_rng(4)
        given = {one: rng.uniform(0.1, 1.0, compiled.size_in(one)) for one in compiled.name_in()}
        if "parameters" in given:
            given["parameters"] = defaults * rng.uniform(0.9, 1.1, len(defaults))
        for one, other in ((compiled, expression), (compiled.jacobian(), expression.jacobian())):
            assert one.name_out() == other.name_out()
            found, expected = one(**given), other(**given)
            for key in one.name_out():
                size = max(np.abs(expected[key].full()).max(initial=0.0), 1.0)
                np.testing.assert_allclose(found[key].full(), expected[key].full(), atol=1e-11 * size)


def test_an_expression_is_not_a_number_without_parameters_and_where_the_mass_matrix_is_singular():
    expression = casadi.expression(SYSTEMS["parameters"]())
    assert np.isnan(expression(x=[0.1, 0.2])["acceleration"].full()).all()
    massless = expression(x=[0.1, 0.2], parameters=[0.0] * 5)["acceleration"]
    assert np.isnan(massless.full()).all()
    with pytest.raises(OptionError, match="step_rk4 makes steps, which are C and no expression"):
        casadi.expression(SYSTEMS["parameters"](), "step_rk4")
