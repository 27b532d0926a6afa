"""Run-time parameters that differ from state to state of a batch: values, every precision, reports, errors.

Expected are the bits of one state after the other, each with its parameters in a library of its own, and the
NumPy reference of the model with these parameters.
"""

from __future__ import annotations

import pickle
import re
import warnings
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.options import TIERS, Variant
from kanegen.recursion.outputs import OUTPUTS as TABLE
from kanegen.recursion.outputs import available
from kanegen.reference import equations as reference
from kanegen.reference.states import random_states
from tests.support.c_compilers import WARNINGS, C, run
from tests.support.cases import slow_except
from tests.support.paths import MODELS
from tests.support.random_trees import everything, other_parameters

QUICK = "-O1 -ffp-contract=off"
OUTPUTS = ("forcing", "forward_dynamics")
VARIANTS = {
    "double": TIERS["strict"],
    "float": TIERS["single"],
    "long double": Variant("long double"),
    "double-double": TIERS["exact"],
    "float arrays": Variant(storage="float"),
    "double arrays": Variant("float", storage="double"),
}


@pytest.fixture(scope="module")
def pendulum() -> kg.System:
    return kg.load(MODELS / "double_pendulum.toml")


@pytest.fixture(scope="module")
def library(pendulum: kg.System) -> kg.Library:
    return kg.build(pendulum, OUTPUTS, flags=QUICK, parameters_by_state=True)


def drawn(library: kg.Library, count: int, seed: int = 0) -> tuple[Any, Any, Any]:
    """Return (B, m) coordinates, (B, n) speeds and (B, P) parameters near the defaults."""
    rng = np.random.default_rng(seed)
    usual = np.array(list(library.parameters.values()))
    x, y = rng.normal(size=(2, count, library.n))
    return x, y, usual * rng.uniform(0.5, 1.5, (count, len(usual)))


def bits(array: Any) -> bytes:
    """Return the numbers of an array as bytes; those of a long double without its padding."""
    array = np.ascontiguousarray(array)
    return array.astype("O").astype(str).tobytes() if array.dtype.itemsize > 8 else array.tobytes()


def one_by_one(library: kg.Library, sets: Any, *inputs: Any, **named: Any) -> list[Any]:
    """Return the accelerations of one state after the other, each by a library with its parameters."""
    return [
        library.with_parameters(dict(zip(library.parameter_names, sets[i], strict=True))).forward_dynamics(
            *(values[i] for values in inputs), **{name: values[i] for name, values in named.items()}
        )
        for i in range(len(sets))
    ]


@pytest.mark.parametrize("seed", slow_except(range(12), 3))
def test_random_trees(seed: int) -> None:
    """Every kind of joint, force element and expression of parameters, with loads and the time."""
    system, count = everything(seed, 2), 11
    library = kg.build(system, OUTPUTS, flags=QUICK, parameters_by_state=True, on_status="ignore")
    sets = np.array([list(other_parameters(system, seed + k).values()) for k in range(count)])
    assert library.parameter_names == tuple(other_parameters(system, seed))
    states = random_states(system, count, seed)
    loads = {} if states.force is None else {"force": states.force, "torque": states.torque}
    named = {**states.inputs, **loads}
    found = library.forward_dynamics(states.x, states.y, **named, parameters=sets)
    assert bits(found) == bits(one_by_one(library, sets, states.x, states.y, **named))
    forcing = library.forcing(states.x, states.y, **named, parameters=sets)
    for i in range(0, count, 5):
        other = system.with_parameters(dict(zip(library.parameter_names, sets[i], strict=True)))
        here = {name: values[i] for name, values in named.items()}
        expected = reference.forcing(other, states.x[i], states.y[i], **here)
        terms = reference.forcing_terms(other, states.x[i], states.y[i], **here)
        size = max(np.abs(part).max() for part in vars(terms).values())
        assert np.abs(forcing[i] - expected).max() <= 1e-12 * size  # as in test_everything_together


@pytest.mark.parametrize("variant", slow_except(VARIANTS, *list(VARIANTS)[::2]))
def test_every_precision(pendulum: kg.System, variant: str) -> None:
    tier = VARIANTS[variant]
    library = kg.build(pendulum, OUTPUTS, tier=tier, flags=QUICK, parameters_by_state=True)
    x, y, sets = drawn(library, 37)
    if library.storage == "double-double":
        x, y = np.stack([x, x * 2.0**-60], axis=-1), np.stack([y, y * 2.0**-60], axis=-1)
    found = library.forward_dynamics(x, y, parameters=sets)
    assert bits(found) == bits(one_by_one(library, sets, x, y))
    same = [library.forward_dynamics(*one, parameters=own) for *one, own in zip(x, y, sets, strict=True)]
    assert bits(found) == bits(same)
    assert bits(library.forward_dynamics(x, y)) == bits(
        [library.forward_dynamics(*one) for one in zip(x, y, strict=True)]
    )


def test_threads_and_lanes_change_no_bit(pendulum: kg.System, library: kg.Library) -> None:
    x, y, sets = drawn(library, 1031)
    expected = bits(library.forward_dynamics(x, y, parameters=sets))
    for flags in (f"{QUICK} -DKANEGEN_LANES=1", f"{QUICK} -DKANEGEN_LANES=8"):
        other = kg.build(pendulum, OUTPUTS, flags=flags, threads=True, parameters_by_state=True)
        assert bits(other.forward_dynamics(x, y, parameters=sets)) == expected


def test_the_same_set_in_every_state_is_the_set_of_the_library(
    pendulum: kg.System, library: kg.Library
) -> None:
    usual = kg.build(pendulum, OUTPUTS, flags=QUICK)
    x, y, sets = drawn(library, 9)
    heavy = dict(zip(library.parameter_names, sets[0], strict=True))
    expected = bits(usual.with_parameters(heavy).forward_dynamics(x, y))
    assert bits(usual.forward_dynamics(x, y, parameters=sets[0])) == expected
    assert bits(usual.forward_dynamics(x, y, parameters=heavy)) == expected
    assert bits(library.with_parameters(heavy).forward_dynamics(x, y)) == expected
    assert bits(library.forward_dynamics(x, y, parameters=np.tile(sets[0], (9, 1)))) == expected
    assert library.parameters == usual.parameters


def test_values_by_name(library: kg.Library) -> None:
    x, y, sets = drawn(library, 9)
    masses = sets[:, library.parameter_names.index("m2")]
    every = np.tile(list(library.parameters.values()), (9, 1))
    every[:, library.parameter_names.index("m2")] = masses
    every[:, library.parameter_names.index("g")] = 1.62
    expected = library.evaluate(x, y, parameters=every)
    found = library.evaluate(x, y, parameters={"m2": masses, "g": 1.62})
    assert bits(found.forward_dynamics) == bits(expected.forward_dynamics)
    assert library.forcing(x[:0], y[:0], parameters={"m2": []}).shape == (0, 2)


def test_a_library_is_pickled(library: kg.Library) -> None:
    x, y, sets = drawn(library, 5)
    again = pickle.loads(pickle.dumps(library))
    assert bits(again.forcing(x, y, parameters=sets)) == bits(library.forcing(x, y, parameters=sets))


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (np.ones((4, 5)), r"parameters: expected shape \(9, 5\) to go with x, got \(4, 5\)\."),
        (np.ones((9, 4)), r"parameters: expected shape \(5,\) or \(B, 5\), got \(9, 4\)\."),
        (["1"] * 5, r"parameters: expected real numbers, got an array of <U1\."),
        ({"m1": np.ones(9), "m2": np.ones(8)}, "parameters: the numbers .* differ: 'm1' 9, 'm2' 8"),
        ({"m1": np.ones((9, 1))}, r"parameter 'm1': expected a number or shape \(B,\), got \(9, 1\)\."),
        ({"mass": 1.0}, "unknown parameter 'mass'. Known are 'g', 'm1'"),
    ],
)
def test_parameters_that_do_not_fit(library: kg.Library, parameters: Any, message: str) -> None:
    x, y, _ = drawn(library, 9)
    with pytest.raises(kg.KanegenError, match=f"^{message}"):
        library.forcing(x, y, parameters=parameters)


def test_sets_for_one_state_or_for_a_library_with_one_set(pendulum: kg.System, library: kg.Library) -> None:
    x, y, sets = drawn(library, 9)
    with pytest.raises(
        kg.KanegenError, match=r"^parameters: expected shape \(5,\) to go with x, got \(9, 5\)"
    ):
        library.forcing(x[0], y[0], parameters=sets)
    usual = kg.build(pendulum, OUTPUTS, flags=QUICK)
    with pytest.raises(kg.KanegenError, match=r"one set .* Build it with parameters_by_state=True\.$"):
        usual.forcing(x, y, parameters=sets)


def test_a_system_without_parameters() -> None:
    system = kg.load(MODELS / "planar_pendulum.toml")
    with pytest.raises(kg.OptionError, match=r"^parameters_by_state: system .* has no run-time parameters"):
        kg.generate(system, parameters_by_state=True)
    with pytest.raises(kg.KanegenError, match=r"^parameters: system .* has no run-time parameters\.$"):
        kg.build(system, flags=QUICK).mass_matrix([0.1], parameters=[1.0])


def test_reports_name_the_state_and_the_parameter(library: kg.Library) -> None:
    x, y, sets = drawn(library, 9)
    good = library.forward_dynamics(x, y, parameters=sets)
    sets[3, library.parameter_names.index("m2")] = np.nan
    sets[5, library.parameter_names.index("l1")] = 0.0
    message = (
        "forward_dynamics: in 2 of 9 states the result does not exist or is not finite; in state 3 the pivot "
        "of [A] at freedom 'q2' of body 'lower' is not positive or is NaN: parameter 'm2' is nan."
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = library.forward_dynamics(x, y, parameters=sets)
    assert [str(one.message) for one in caught] == [message]
    assert caught[0].filename == __file__
    rows = np.delete(np.arange(9), [3, 5])
    assert bits(found[rows]) == bits(good[rows])
    assert np.isnan(found[[3, 5]]).all()
    with pytest.raises(kg.SingularError, match=re.escape(message)):
        library.with_on_status("raise").forward_dynamics(x, y, parameters=sets)


def test_what_only_prepared_constants_show_is_reported_once(library: kg.Library) -> None:
    """A length so large that its square overflows does not show in results that do not take it."""
    x, y, sets = drawn(library, 9)
    sets[2, library.parameter_names.index("l1")] = 1e200
    with pytest.warns(kg.KanegenWarning, match="^prepare: in 1 of 9 states .* in state 2 prepared") as caught:
        found = library.forcing(x, np.zeros_like(y), parameters=sets)
    assert len(caught) == 1
    assert np.isfinite(found).all()


@pytest.mark.parametrize("compiler", slow_except(C, "gcc"))
@pytest.mark.parametrize("precision", ["double", "float"])
def test_the_c_is_clean_and_the_example_runs(
    pendulum: kg.System, precision: str, compiler: str, tmp_path: Any
) -> None:
    source = kg.generate(pendulum, precision=precision, parameters_by_state=True)
    folder = source.write(tmp_path / "out")
    assert " *     parameters: by state\n" in source.files["double_pendulum.h"]
    assert "`double_pendulum_prepare_batch` fills a row of `prepared` for each" in source.files["README.md"]
    files = ("double_pendulum.c", "double_pendulum_batch.c", "main.c")
    run(*C[compiler], "-std=c99", "-O1", *WARNINGS, *files, "-lm", "-o", "example", folder=folder)
    usual = kg.generate(pendulum, precision=precision).write(tmp_path / "usual")
    run(*C[compiler], "-std=c99", "-O1", *files, "-lm", "-o", "example", folder=usual)
    assert run("./example", folder=folder) == run("./example", folder=usual)


def test_rollouts_and_steps_take_sets_too(pendulum: kg.System) -> None:
    library = kg.build(pendulum, ("rollout_rk4", "step_rk4"), flags=QUICK, parameters_by_state=True)
    x, y, sets = drawn(library, 13)
    found = library.rollout(x, y, steps=20, step=0.01, every=5, parameters=sets)
    for i in range(13):
        own = library.with_parameters(dict(zip(library.parameter_names, sets[i], strict=True)))
        alone = own.rollout(x[i], y[i], steps=20, step=0.01, every=5)
        assert bits(found.x[i]) == bits(alone.x)
        assert bits(found.y[i]) == bits(alone.y)
    ends = library.step(x, y, step=0.01, parameters=sets)
    assert bits(library.rollout(x, y, steps=1, step=0.01, parameters=sets).x[:, 1]) == bits(ends[0])
    sets[4, library.parameter_names.index("l2")] = np.inf
    with pytest.warns(kg.KanegenWarning, match=r"first in state 4, after 0 of 20 .* parameter 'l2' is inf"):
        library.rollout(x, y, steps=20, step=0.01, parameters=sets)
    with pytest.warns(kg.KanegenWarning, match=r"after 0 of 20 .* parameter 'l2' is inf"):
        library.rollout(x[4], y[4], steps=20, step=0.01, parameters=sets[4])


@pytest.mark.slow
def test_every_output_takes_sets() -> None:
    system = kg.load(MODELS / "gantry_crane.toml").with_points({"hook": (1, (0, 0, 0.1))})
    names = available(system)
    library = kg.build(system, names, flags="-O0", parameters_by_state=True, on_status="ignore")
    rng = np.random.default_rng(0)
    usual = np.array(list(library.parameters.values()))
    sets = usual * rng.uniform(0.8, 1.2, (5, len(usual)))
    given = dict(zip(("x", "y", "ydot", "tau"), rng.normal(size=(4, 5, library.n)), strict=True))
    owners = [library.with_parameters(dict(zip(library.parameter_names, own, strict=True))) for own in sets]
    for name in names:
        inputs = {one: given[one] for one in TABLE[name].arguments if one in given}
        many = getattr(library, name)(**inputs, parameters=sets)
        for i, owner in enumerate(owners):
            alone = getattr(owner, name)(**{one: value[i] for one, value in inputs.items()})
            assert bits(many[i]) == bits(alone), name
