"""The one rule for results that are missing, not finite or not accurate: every function, state and batch."""

from __future__ import annotations

import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.c import interface, render
from kanegen.library import load
from kanegen.library.native.status import INACCURATE, MISSING, NOT_FINITE, StatusReport
from kanegen.options import TIERS, Variant
from kanegen.program.check import check
from kanegen.program.ir import Module, Op
from kanegen.program.precision import precision_named
from kanegen.simulation import simulate
from kanegen.simulation.methods import ADAPTIVE, FIXED
from tests.support import systems
from tests.support.c_compilers import CPP, WARNINGS, C, code, run
from tests.support.cases import slow_except
from tests.support.handmade import F, Listing, X, description, source
from tests.support.pivot_programs import BAD, GOOD, source_with_pivots
from tests.support.refinement import rods

QUICK = "-O1 -ffp-contract=off"
VARIANTS = {
    "double": TIERS["strict"],
    "float": TIERS["single"],
    "long double": Variant("long double"),
    "double-double": TIERS["exact"],
    "float arrays": Variant(storage="float"),
    "double arrays": Variant("float", storage="double"),
    "fast": TIERS["fast"],
}


def hinges(*elements: kg.ForceElement) -> kg.System:
    """Return two hinges with force elements, bodies "body1" and "body2"."""
    chain = systems.chain(2)
    return kg.System(chain.name, chain.bodies, force_elements=elements)


def quotient() -> kg.System:
    """Return two hinges with an effort 1/x at the second, which is undefined where its angle is 0."""
    return hinges(kg.Drive("body2.theta3", "1/x.body2.theta3"))


@pytest.mark.parametrize("on_status", ["warn", "raise", "ignore"])
def test_an_undefined_expression(on_status: str) -> None:
    library = kg.build(quotient(), ("mass_matrix", "forcing"), flags=QUICK, on_status=on_status)
    x, y = np.array([0.1, 0.0]), np.zeros(2)
    message = r"forcing: f\[1\] is inf, at freedom 'body2.theta3' of body 'body2', .* 1\.0 / x\.body2\.theta3"
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        if on_status == "raise":
            with pytest.raises(kg.StatusError, match=message):
                library.forcing(x, y)
        else:
            assert library.forcing(x, y)[1] == np.inf
    assert len(caught) == (on_status == "warn")
    for one in caught:
        assert one.filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isfinite(library.mass_matrix(x)).all()
        assert np.isfinite(library.forcing([0.1, 0.2], y)).all()


@pytest.mark.parametrize(
    ("text", "is_named"),
    [
        ("2/x.body2.theta3", True),
        ("x.body2.theta3**-1", True),
        ("x.body2.theta3/2", False),
        ("x.body1.theta3**3", False),
    ],
)
def test_elements_that_are_defined_everywhere_are_not_named(text: str, is_named: bool) -> None:
    """Something is undefined at 0: the drive of the second hinge, and in half of the cases another."""
    elements = (
        kg.JointSpring("body1.theta3", 3.0),
        kg.Drive("body1.theta3", text),
        *quotient().force_elements,
    )
    library = kg.build(hinges(*elements), ("forcing",), flags=QUICK)
    with pytest.warns(
        kg.KanegenWarning, match="force element may be undefined in this state: drive: "
    ) as caught:
        library.forcing([0.1, 0.0], np.zeros(2))
    (message,) = (str(one.message) for one in caught)
    assert "1.0 / x.body2.theta3" in message
    assert "joint_spring" not in message
    assert ("body1.theta3" in message.partition("in this state")[2]) == is_named


@pytest.mark.parametrize("variant", slow_except(VARIANTS, "double", "fast"))
@pytest.mark.parametrize("by_rows", [False, True])
def test_a_result_is_reported_exactly_where_it_is_not_finite(
    variant: str, by_rows: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In all functions, for states with infinite, huge and missing numbers, one by one and in batches."""
    if by_rows:
        monkeypatch.setattr(interface, "LARGEST_BATCH_ROW", 1)
    found: list[StatusReport] = []
    outputs = ("mass_matrix", "forcing", "forward_dynamics", "kinetic_energy", "potential_energy")
    library = kg.build(quotient(), outputs, flags=QUICK, tier=VARIANTS[variant], on_status=found.append)
    x, y = poisoned(library, 41)
    for name in outputs:
        arguments = (x,) if name in ("mass_matrix", "potential_energy") else (x, y)
        results = getattr(library, name)(*arguments)
        finite = np.isfinite(results.reshape(len(x), -1)).all(axis=1)
        assert 0 < finite.sum() < len(x)
        (batch,) = [one for one in found if one.kind != INACCURATE]
        assert (batch.states, batch.is_alone) == ((~finite).sum(), False)
        assert f"{name}: in {batch.states} of 41 states" in batch.message
        assert f"; in state {np.argmin(finite)} " in batch.message
        for state in range(len(x)):
            found.clear()
            getattr(library, name)(*(array[state] for array in arguments))
            assert [one.kind in (MISSING, NOT_FINITE) for one in found] == [True] * (not finite[state]), state
        found.clear()


def poisoned(library: kg.Library, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return states of which about half contain numbers that are infinite, NaN or huge."""
    rng = np.random.default_rng(5)
    dtype = {"float": np.float32, "long double": np.longdouble}.get(library.storage, np.float64)
    states = rng.normal(size=(2, count, library.n))
    huge = 1e38 if np.float32 in (dtype, {"float": np.float32}.get(library.precision)) else 1e308
    for _ in range(count // 2):
        place = tuple(rng.integers(0, states.shape))
        states[place] = rng.choice([np.nan, np.inf, -np.inf, huge])
    with np.errstate(over="ignore"):
        x, y = states.astype(dtype)
    return x, y


def test_what_storage_rounds_to_infinity_is_not_finite() -> None:
    """Sums of floats next to half a unit above the largest float, computed in double and stored as floats."""
    k = Listing()
    program = check(k.program([X], {F: [k(Op.ADD, k.read("x", 0), k.read("x", 1)), k.read("x", 0)]}))
    made = render(
        description(parameters=False, loads=False),
        Module(None, {"mass_matrix": program}),
        {},
        Variant(storage="float"),
    )
    found: list[StatusReport] = []
    library = load(made, flags=QUICK, on_status=found.append)
    largest, half = np.finfo(np.float32).max, np.float32(2.0**103)
    least = np.nextafter(half, np.float32(0.0))
    x = np.array([[largest, least], [largest, half], [-largest, -half], [-largest, -least]], np.float32)
    assert np.isinf(library.mass_matrix(x)[:, 0]).tolist() == [False, True, True, False]
    assert found.pop().states == 2
    for row in x:
        library.mass_matrix(row)
    hint = "although every input is finite: a number overflows, or something is divided by 0."
    assert [one.message for one in found] == [
        f"mass_matrix: f[0] is {one}, {hint}" for one in ("inf", "-inf")
    ]


def test_prepared_constants() -> None:
    """What depends on parameters alone is reported where the parameters are set."""
    library = load(source(), flags=QUICK)
    with pytest.warns(
        kg.KanegenWarning, match=r"^prepare: prepared\[0\] is inf, .* set were m1 = 1e\+200, sin = 1e\+200\.$"
    ) as caught:
        library.with_parameters({"m1": 1e200, "sin": 1e200})
    assert caught[0].filename == __file__
    with pytest.raises(
        kg.StatusError, match=r"^prepare: prepared\[0\] is inf, .* set were m1 = 1e\+200, sin"
    ):
        library.with_on_status("raise").with_parameters({"m1": 1e200, "sin": 1e200})
    quiet = library.with_on_status("ignore").with_parameters({"m1": 1e200, "sin": 1e200})
    assert quiet.mass_matrix([0.0, 0.0])[0, 0] == np.inf


def test_a_batch_names_the_first_state_of_each_kind() -> None:
    """The same states as single calls report, in one report."""
    library = load(source_with_pivots(), flags=QUICK, on_status="raise")
    x = np.array([*GOOD, *(state for _, state in BAD)])
    with pytest.raises(
        kg.SingularError, match=r"^forward_dynamics: in 8 of 13 .* in state 5 the pivot of \[A\]"
    ):
        library.forward_dynamics(x, np.ones_like(x))
    found: list[StatusReport] = []
    arm = kg.build(
        rods(8.0), "forward_dynamics", tier=Variant("float", "factorisation", refinement=1), flags=QUICK
    ).with_on_status(found.append)
    y = np.random.default_rng(3).uniform(-1, 1, (2, 64, arm.n)).astype(np.float32)
    y[0, 40, 2] = np.nan
    kinds = []
    for state in range(64):
        arm.forward_dynamics(y[0, state], y[1, state])
        kinds.append(found.pop().kind if found else "")
    arm.forward_dynamics(y[0], y[1])
    (batch,) = found
    doubtful = kinds.count(INACCURATE)
    assert doubtful > 0
    assert batch.states == doubtful + kinds.count(MISSING)
    assert f"in {doubtful} of 64 states the result is not accurate; in state {kinds.index(INACCURATE)} " in (
        batch.message
    )


@pytest.mark.parametrize("variant", slow_except(("double", "float", "double-double"), "double"))
def test_a_quaternion_without_length_is_named_and_not_blamed_on_the_mass_matrix(variant: str) -> None:
    system = systems.chain(2, ("theta1", "theta2", "theta3")).with_coordinates("quaternion")
    outputs = ("mass_matrix", "forcing", "forward_dynamics")
    library = kg.build(system, outputs, tier=VARIANTS[variant], flags=QUICK)
    precision = precision_named(library.storage)

    def stored(values: list[float]) -> np.ndarray:
        return precision.from_doubles(np.array(values))

    x, y = stored([1.0, 0, 0, 0, 0, 0, 0, 0]), stored([0.0] * 6)
    clause = "x has a quaternion of length 0, which is no orientation: 'body2.e0' to 'body2.e3'"
    with pytest.raises(kg.SingularError, match=clause) as error:
        library.forward_dynamics(x, y)
    assert "singular" not in str(error.value)
    with pytest.warns(kg.KanegenWarning, match=clause):
        library.mass_matrix(np.stack([x, x]))
    tiny = stored([1.0, 0, 0, 0, 1e-30 if variant == "float" else 1e-170, 0, 0, 0])
    with pytest.raises(kg.SingularError, match=r"a length whose square is 0\.0, which is no orientation"):
        library.forward_dynamics(tiny, y)


def test_rules_are_checked_and_kept() -> None:
    library = load(source_with_pivots(), flags=QUICK, on_status="raise")
    singular = BAD[0][1]
    again = pickle.loads(pickle.dumps(library))
    assert (again.on_status, library.with_on_status("ignore").on_status) == ("raise", "ignore")
    with pytest.raises(kg.StatusError):
        again.forward_dynamics(singular, [0.0, 0.0])
    assert np.isnan(library.with_on_status("ignore").forward_dynamics(singular, [0.0, 0.0])).all()
    for wrong in ("warm", None, 3, True):
        with pytest.raises(
            kg.OptionError, match=r"unknown on_status .* A function that takes a StatusReport fits"
        ):
            library.with_on_status(wrong)
        with pytest.raises(kg.OptionError, match="unknown on_status"):
            kg.build(quotient(), on_status=wrong)


def test_derivatives_and_evaluate() -> None:
    library = kg.build(quotient(), ("forcing", "forcing_derivatives"), flags=QUICK)
    x, y = np.array([[0.1, 0.5], [0.1, 0.0]]), np.zeros((2, 2))
    for function in (library.forcing_derivatives, library.evaluate):
        with pytest.warns(
            kg.KanegenWarning, match="in 1 of 2 states .* in state 1 f.* at freedom 'body2.theta3'"
        ):
            function(x, y)


def test_simulations_report_once() -> None:
    """One warning with the time for a whole motion, or an error at the first time."""
    tier = Variant("float", "factorisation", refinement=1)
    library = kg.build(rods(8.0, 6), "forward_dynamics", tier=tier, flags=QUICK)
    start = np.linspace(-1.0, 1.0, 6), np.zeros(6)
    with pytest.warns(
        kg.KanegenWarning,
        match=r"^at t = \S+ s: forward_dynamics: .* \d+ of 40 evaluations were not accur",
    ) as caught:
        simulate(library, *start, [0.0, 1e-4], step=1e-5)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    with pytest.raises(kg.StatusError, match=r"^at t = \S+ s: forward_dynamics: the result is not accurate"):
        simulate(library.with_on_status("raise"), *start, [0.0, 1e-4], step=1e-5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        simulate(library.with_on_status("ignore"), *start, [0.0, 1e-4], step=1e-5)


@pytest.mark.parametrize("on_status", slow_except(("warn", "raise", "ignore"), "raise"))
@pytest.mark.parametrize("method", [*FIXED, *ADAPTIVE])
def test_a_motion_through_an_undefined_force_element(method: str, on_status: str) -> None:
    """[A] is regular; at the first time no step helps, later a smaller one might."""
    library = kg.build(quotient(), "forward_dynamics", flags=QUICK, on_status=on_status)
    options = {"step": 0.125} if method in FIXED else {}
    with pytest.raises(kg.StatusError, match=r"^at t = \S+ s: forward_dynamics: .* 1.0 / x[^ ]*\.$") as first:
        simulate(library, [0.1, 0.0], [0.0, 0.0], [0.0, 1.0], method, **options)
    assert not isinstance(first.value, kg.SingularError)


@pytest.mark.parametrize("on_status", ["warn", "ignore"])
def test_a_motion_that_stops_being_finite(on_status: str) -> None:
    """The second evaluation of a step of 1 s is at angle 0, where 1/x is undefined; that of 0.5 s is not."""
    library = kg.build(quotient(), "forward_dynamics", flags=QUICK, on_status=on_status)
    with pytest.raises(kg.StatusError, match=r"^at t = \S+ s: .* smaller step") as found:
        simulate(library, [0.1, 1.0], [0.0, -2.0], [0.0, 1.0], step=1.0)
    assert not isinstance(found.value, kg.SingularError)


def test_an_argument_of_another_function_is_named() -> None:
    library = load(source_with_pivots(), flags=QUICK)
    plain = load(source(), flags=QUICK)
    with pytest.raises(
        kg.ArrayError, match=r"^tau: forcing does not depend on it\. Its arguments are x, y, force, torque\."
    ):
        plain.forcing([0.0, 0.0], [0.0, 0.0], tau=[1.0, 0.0])
    with pytest.raises(
        kg.ArrayError, match=r"^ydot: mass_matrix does not depend on it\. Its arguments are x\.$"
    ):
        plain.mass_matrix([0.0, 0.0], ydot=[1.0, 0.0])
    with pytest.raises(kg.ArrayError, match=r"^taw: there is no such argument\. Did you mean 'tau'\?$"):
        library.forward_dynamics([0.0, 0.0], [0.0, 0.0], taw=[1.0, 0.0])
    with pytest.raises(kg.ArrayError, match=r"^taw: there is no such argument\. Known are 'x'\.$"):
        plain.mass_matrix([0.0, 0.0], taw=[1.0, 0.0])


@pytest.mark.parametrize(
    "variant", slow_except(("double", "float", "long double", "double-double", "fast"), "double", "fast")
)
def test_what_c_returns(variant: str, tmp_path: Path) -> None:
    """Status and count in C and C++, without a warning; a compiler that assumes finite numbers is named."""
    tier = VARIANTS[variant]
    made = kg.generate(quotient(), ("mass_matrix", "forcing"), tier=tier, artifacts="example")
    made.write(tmp_path)
    kind = {"float": "float", "long double": "long double"}.get(variant, "double")  # of the arrays
    (tmp_path / "ask.c").write_text(
        '#include <stdio.h>\n#include "chain.h"\nint main(void) {\n'
        f"    const {kind} x[3][2] = {{{{0, 1}}, {{0, 0}}, {{1, 2}}}}, y[3][2] = {{{{0, 0}}}};\n"
        f"    {kind} A[3][4], f[3][2];\n"
        '    for (int i = 0; i < 3; ++i) printf("%d ", chain_evaluate(x[i], y[i], A[i], f[i]));\n'
        '    for (int i = 0; i < 3; ++i) printf("%d ", chain_mass_matrix(x[i], A[i]));\n'
        '    printf("%d %d %d\\n", (int)chain_forcing_batch(3, x[0], y[0], f[0]),\n'
        "           (int)chain_evaluate_batch(3, x[0], y[0], A[0], f[0]), CHAIN_NOT_FINITE);\n"
        "    return 0;\n}\n"
    )
    for compiler in C.values():
        run(*compiler, "-std=c99", "-O2", *WARNINGS, "-c", "main.c", folder=tmp_path)
        run(*compiler, *tier.flags, *WARNINGS, *code("chain"), "ask.c", "-lm", "-o", "ask", folder=tmp_path)
        assert run("./ask", folder=tmp_path).split() == "0 3 0 0 0 0 1 1 3".split()
    run(*CPP["g++"], "-std=c++11", "-fsyntax-only", "-x", "c++", "chain.h", folder=tmp_path)


def test_a_compiler_that_assumes_finite_numbers_is_named() -> None:
    sentence = "compiler may assume that no number is infinite or NaN"
    for semantics, is_named in ((("finite",), True), (("strict",), False)):
        files = kg.generate(quotient(), tier=Variant(semantics=semantics), artifacts="readme").files
        for name in ("chain.h", "README.md"):
            assert (sentence in " ".join(files[name].replace(" * ", " ").split())) == is_named
