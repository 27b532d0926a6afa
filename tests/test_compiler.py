"""The compiler as a whole: options, progress, and errors."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import kanegen as kg
from tests.support import systems


@pytest.fixture
def pendulum() -> kg.System:
    return systems.chain(2, ["theta3"])


def massless_leaf() -> kg.System:
    hinge = kg.Joint((1.0, 0.0, 0.0), free=(False, True, False, False, False, False), name="elbow")
    trunk = kg.Body("trunk", 0, 1.0, np.eye(3).tolist())
    return kg.System("arm", (trunk, kg.Body("hand", 1, 0.0, np.zeros((3, 3)).tolist(), joint=hinge)))


@pytest.mark.parametrize("outputs", ["forcing", ("forcing",), ["forcing", "forcing"], {"forcing": 1}])
def test_one_output_gives_one_function(pendulum: kg.System, outputs: object) -> None:
    source = kg.generate(pendulum, outputs=outputs)  # type: ignore[arg-type]
    assert source.outputs == ("forcing",)
    assert [function.name for function in source.functions] == ["forcing"]


def test_all_outputs_share_one_more_function(pendulum: kg.System) -> None:
    source = kg.generate(pendulum, outputs=("forcing", "mass_matrix"))
    assert source.outputs == ("mass_matrix", "forcing")
    assert [function.name for function in source.functions] == ["mass_matrix", "forcing", "evaluate"]


@pytest.mark.parametrize("make", [kg.generate, kg.build])
def test_unknown_outputs(make: Callable[..., object], pendulum: kg.System) -> None:
    with pytest.raises(kg.OptionError, match=r"unknown output 'mas_matrix'.*Did you mean 'mass_matrix'\?"):
        make(pendulum, outputs=("mas_matrix",))
    with pytest.raises(kg.OptionError, match="no output is asked for"):
        make(pendulum, outputs=())
    with pytest.raises(kg.OptionError, match="unknown output 3"):
        make(pendulum, outputs=(3,))


@pytest.mark.parametrize("make", [kg.generate, kg.build])
def test_what_a_singular_system_lacks_is_named(make: Callable[..., object]) -> None:
    message = (
        r"^body 'hand': freedom 'elbow' moves neither mass nor inertia, so \[A\] is singular in every state "
        r"and has no inverse, which forward_dynamics and forward_dynamics_derivatives would need\. Give "
        r"'hand' mass or inertia that moves with it, or lock the freedom\. Outputs that do not need it: "
        r"mass_matrix, forcing, .*inverse_dynamics_derivatives, .*inverse_dynamics_second_derivatives\.$"
    )
    with pytest.raises(kg.SingularError, match=message) as found:
        make(massless_leaf(), ("mass_matrix", "forward_dynamics_derivatives", "forward_dynamics"))
    for name in ("error_estimate", "error_bound", "regularity"):
        assert name not in str(found.value)
        with pytest.raises(kg.SingularError, match=f"no inverse, which {name} would need"):
            make(massless_leaf(), name)


def test_a_singular_system_has_equations() -> None:
    assert kg.compare(massless_leaf(), states=20).passed
    elbow = massless_leaf().freedom_names.index("elbow")
    assert not any(kg.derive(massless_leaf()).A[elbow, :])


@pytest.mark.parametrize("make", [kg.derive, kg.generate, kg.build, kg.compare])
def test_the_path_of_a_model_is_no_system(make: Callable[..., object]) -> None:
    with pytest.raises(kg.OptionError, match=r"'models/arm.toml' is no System. Make one with kg.load"):
        make("models/arm.toml")


def test_progress_names_the_stages(pendulum: kg.System) -> None:
    stages: list[str] = []
    kg.build(pendulum, progress=stages.append)
    assert stages == ["deriving", "lowering", "optimising", "printing", "compiling"]


def test_constants_out_of_range_are_an_error() -> None:
    heavy = kg.Body("a", 0, 1e300, np.eye(3).tolist(), (1e10, 1.0, 1.0))
    with pytest.raises(kg.ModelError, match="range of double precision"):
        kg.generate(kg.System("heavy", (heavy,)))


@pytest.mark.parametrize(
    "error", [kg.ModelError, kg.OptionError, kg.ArrayError, kg.WriteError, kg.BuildError]
)
def test_every_error_is_a_value_error(error: type[Exception]) -> None:
    assert issubclass(error, kg.KanegenError)
    assert issubclass(error, ValueError)
