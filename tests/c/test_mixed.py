"""Arrays of one precision, arithmetic of another: nothing but inputs and results is rounded."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import ModelError, OptionError, SingularError
from kanegen.library import load
from kanegen.measure.comparison import compare
from kanegen.measure.truth import measure
from kanegen.options import Variant
from kanegen.program.precision import DOUBLE, FLOAT, LONG_DOUBLE
from kanegen.reference.states import random_states
from tests.support.c_compilers import WARNINGS, C, code, run
from tests.support.cases import slow_except
from tests.support.command import kanegen
from tests.support.handmade import bits, source
from tests.support.paths import PENDULUM
from tests.support.simd import FLAGS, wide
from tests.support.systems import random_system

OUTPUTS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")
MIXED = Variant(storage="float")


def tree(seed=1, bodies=3):
    return random_system(np.random.default_rng(seed), bodies, loads=True)


def inputs(system, seed=2, count=13):
    """Return numbers that a float can hold, as doubles."""
    rng = np.random.default_rng(seed)
    x, y, ydot, tau = rng.uniform(-2, 2, (4, count, len(system.freedoms))).astype(np.float32).astype(float)
    force, torque = (
        rng.uniform(-2, 2, (2, count, system.number_of_bodies, 3)).astype(np.float32).astype(float)
    )
    return (x, y, force, torque), {"ydot": ydot, "tau": tau}


@pytest.mark.parametrize(
    ("arithmetic", "storage"),
    [
        pytest.param(*both, marks=[pytest.mark.slow] * (both != ("double", "float")))
        for both in itertools.permutations(["double", "float", "long double"], 2)
    ],
)
def test_results_are_those_of_the_arithmetic_rounded_once(arithmetic, storage):
    """For one state and in batches, only loading and storing differ from plain double precision."""
    system = tree(bodies=2)
    plain = kg.build(system, OUTPUTS, flags=FLAGS, precision=arithmetic)
    mixed = kg.build(system, OUTPUTS, flags=FLAGS, tier=Variant(precision=arithmetic, storage=storage))
    assert (mixed.precision, mixed.storage) == (arithmetic, storage)
    states, others = inputs(system)
    dtype = {"float": np.float32, "double": np.float64, "long double": np.longdouble}[storage]
    for row in (slice(None), 0, slice(3)):
        given = [value[row] for value in states], {name: value[row] for name, value in others.items()}
        found, expected = (library.evaluate(*given[0], **given[1]) for library in (mixed, plain))
        for output in OUTPUTS:
            value, exact = getattr(found, output), getattr(expected, output)
            assert value.dtype == dtype
            np.testing.assert_array_equal(value, exact.astype(dtype), err_msg=output)


@pytest.mark.parametrize("width", slow_except([1, 2, 4, 8], 4))
def test_widths_and_places_do_not_matter(width):
    system = tree(4, 2)
    library = kg.build(system, OUTPUTS, flags=wide(width), tier=MIXED)
    states, others = inputs(system, count=19)
    whole = library.evaluate(*states, **others)
    alone = kg.build(system, OUTPUTS, flags=wide(1), tier=MIXED)
    for output, value in zip(OUTPUTS, alone.evaluate(*states, **others), strict=True):
        np.testing.assert_array_equal(getattr(whole, output), value)
    for count in (1, 7, 8, 9):
        part = library.evaluate(*(v[:count] for v in states), **{k: v[:count] for k, v in others.items()})
        np.testing.assert_array_equal(part.forcing, whole.forcing[:count])


@pytest.mark.slow
def test_errors_are_one_rounding():
    """The certified error is half a unit in the last place of a float, and the error of double precision."""
    system = tree(2)
    library = kg.build(system, OUTPUTS, flags=FLAGS, tier=MIXED)
    states = random_states(system, 4, 1)
    for output, measured in measure(system, library, states, None, states.y).items():
        assert measured.within_bound, output
        assert (measured.normwise <= 2.0**-24 * (1 + 1e-6)).all(), output
    single = kg.build(system, OUTPUTS, flags=FLAGS, precision="float")
    for output, measured in measure(system, single, states, None, states.y).items():
        assert (measured.normwise > 2.0**-24).any(), output


def test_the_check_knows_both():
    system = tree(3)
    library = kg.build(system, flags=FLAGS, tier=MIXED)
    report = compare(system, library, 30, storage=FLOAT)
    assert report.passed, str(report)
    assert report.accuracies[0].bound == 8 * (3 + 8) * 2.0**-53 + 2.0**-24
    assert report.reason.endswith("Results are rounded once more, by 2^-24.")
    assert not compare(system, library, 30).passed
    assert kg.compare(system, 30, tier=MIXED).passed
    assert kg.compare(system, 30, tier=replace(MIXED, precision="float", storage="double")).passed


def test_parameters_are_not_rounded_to_the_storage():
    """Run-time parameters have the precision of the arithmetic, not of the arrays."""
    system = kg.load("models/gantry_crane.toml")
    mixed, plain = (kg.build(system, OUTPUTS, flags=FLAGS, tier=tier) for tier in (MIXED, "strict"))
    mixed, plain = (library.with_parameters({"load_mass": 0.1}) for library in (mixed, plain))
    states, others = inputs(system)
    for output, value in zip(OUTPUTS, mixed.evaluate(*states[:2], **others), strict=True):
        exact = getattr(plain.evaluate(*states[:2], **others), output)
        np.testing.assert_array_equal(value, exact.astype(np.float32))
    assert "const double *parameters" not in mixed.source.cdef
    assert "const double parameters[" in mixed.source.cdef
    with pytest.raises(ModelError, match="unknown parameter 'm'"):
        mixed.with_parameters({"m": 1.0})


def test_status():
    """Rows of failed states are NaN in arrays of floats, too."""
    system = kg.System.from_arrays([0], [1.0], [np.eye(3)], [[0, 0, 0]], [[0, 0, 0]])
    library = kg.build(system, "forward_dynamics", flags=FLAGS, tier=MIXED)
    bad, good = np.zeros(6), np.full(6, 0.1)
    bad[1] = np.nan
    with pytest.raises(SingularError, match="forward_dynamics"):
        library.forward_dynamics(bad, good)
    with pytest.warns(kg.errors.KanegenWarning, match="in 1 of 3 states"):
        found = library.forward_dynamics([good, bad, good], [good] * 3)
    np.testing.assert_array_equal(np.isnan(found).all(axis=1), [False, True, False])


def test_results_that_storage_cannot_hold_are_refused():
    body = kg.Body("body", 0, 1e39, np.eye(3))
    with pytest.raises(ModelError, match=r"a result: 1e\+39 leaves the range of single precision"):
        kg.generate(kg.System("big", (body,)), tier=MIXED)


@pytest.mark.parametrize("compiler", C)
@pytest.mark.parametrize(
    "arithmetic",
    slow_except((DOUBLE, FLOAT, LONG_DOUBLE), FLOAT),
    ids=lambda precision: precision.name,
)
def test_c_is_clean(compiler, arithmetic, tmp_path):
    storages = {"double", "float", "long double"} - {arithmetic.name}
    for storage in sorted(storages):
        folder = source(precision=arithmetic, storage=storage).write(tmp_path / storage)
        for file in ("handmade.c", "handmade_batch.c", "main.c"):
            run(*C[compiler], "-std=c99", "-O1", *WARNINGS, "-c", file, folder=folder)
        run(*C[compiler], "-std=c99", "main.c", *code("handmade"), "-o", "example", folder=folder)
        assert run("./example", folder=folder).count(" = ") == 2 + 2 * 6


@pytest.mark.slow
def test_long_functions_in_parts_are_clean(tmp_path):
    """Numbers that one part of a function leaves for the next are not rounded to the storage."""
    system = random_system(np.random.default_rng(7), 7, loads=True)
    folder = kg.generate(system, OUTPUTS, tier=MIXED).write(tmp_path / "out")
    assert "double *w" in (folder / "tree.c").read_text()
    for file in ("tree.c", "tree_batch.c"):
        run(*C["gcc"], "-std=c99", "-O0", *WARNINGS, "-c", file, folder=folder)


def test_bits_of_other_variants_do_not_change():
    """Naming a precision's own storage is the same as naming none."""
    named = load(source(storage="double"), flags=FLAGS)
    x, y = np.random.default_rng(1).normal(size=(2, 5, 2))
    assert bits(named.forcing(x, y)) == bits(load(source(), flags=FLAGS).forcing(x, y))


def test_the_command_line(tmp_path):
    kanegen("generate", PENDULUM, "-o", str(tmp_path / "out"), "--storage", "float")
    header = (tmp_path / "out" / "double_pendulum.h").read_text().replace("\n *", "")
    assert "const float x[2]" in header
    assert "All is computed in double precision. States, loads and results are of type float" in header
    assert "by 2^-24" in kanegen("check", PENDULUM, "--states", "20", "--storage", "float").stdout
    error = kanegen("check", PENDULUM, "--storage", "double-double", status=2).stderr
    assert "storage 'double-double' does not go with precision 'double'" in error
    with pytest.raises(OptionError, match="does not go with precision"):
        Variant(precision="float", storage="double-double")
