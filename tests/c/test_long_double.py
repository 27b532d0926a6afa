"""Arithmetic in long double, against certified truth."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import BuildError, ModelError
from kanegen.library.native import build
from kanegen.measure.truth import measure
from kanegen.options import Variant
from kanegen.program.precision import LONG_DOUBLE
from kanegen.reference.states import random_states
from tests.support.c_compilers import SANITIZERS, WARNINGS, C, code, printed, run
from tests.support.cases import slow_except
from tests.support.command import kanegen
from tests.support.handmade import evaluate, module, source
from tests.support.paths import PENDULUM
from tests.support.systems import random_system

OUTPUTS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")
QUICK = ("-O0", "-ffp-contract=off")
LONG = Variant(precision="long double")


@pytest.mark.parametrize("storage", ["", "double"])
@pytest.mark.parametrize("seed", slow_except((1, 2), 2))
def test_random_trees_keep_the_bound_of_64_bits(seed, storage):
    """The trees have constant angles, whose sines would be off by 2^-53 if they were doubles."""
    system = random_system(np.random.default_rng(seed), 3, loads=True)
    library = kg.build(system, OUTPUTS, flags=QUICK, tier=replace(LONG, storage=storage))
    states = random_states(system, 4, seed)
    tau, ydot = np.random.default_rng(seed).normal(size=(2, *states.x.shape))
    for output, measured in measure(system, library, states, tau, ydot).items():
        assert measured.within_bound, output
        worst = measured.normwise.max()
        assert (1e-17 < worst <= 2.0**-53) if storage else (1e-21 < worst < 1e-17), output


def test_arrays_are_longdouble():
    system = random_system(np.random.default_rng(3), 3, loads=True)
    library = kg.build(system, OUTPUTS[:2], flags=QUICK, precision="long double")
    assert (library.precision, library.storage) == ("long double", "long double")
    n = library.n
    x, y = np.random.default_rng(1).normal(size=(2, 5, n)).astype(np.longdouble)
    x += np.longdouble(2) ** -60
    found = library.forcing(x, y)
    assert found.dtype == np.longdouble
    assert library.mass_matrix(x[0]).shape == (n, n)
    np.testing.assert_array_equal(library.forcing(x[2], y[2]), found[2])
    assert (library.forcing(x.astype(float), y) != found).any()  # the last bits of x count


def test_parts_are_doubles_whose_sum_is_the_number():
    rng = np.random.default_rng(5)
    values = rng.normal(size=200).astype(np.longdouble) + rng.normal(size=200) * np.longdouble(2) ** -58
    first, *others = LONG_DOUBLE.parts(values)
    assert all(part.dtype == np.float64 for part in (first, *others))
    np.testing.assert_array_equal(first, values.astype(float))
    assert any(part.any() for part in others)
    np.testing.assert_array_equal(sum(reversed(others), start=np.longdouble(0)) + first, values)


def test_prepared_constants_have_all_bits():
    library = kg.build(kg.load("models/gantry_crane.toml"), flags=QUICK, precision="long double")
    again = library.with_parameters({"load_mass": 1 / 3})
    states = random_states(kg.load("models/gantry_crane.toml"), 3, 1)
    for measured in measure(kg.load("models/gantry_crane.toml"), again, states).values():
        assert measured.within_bound
        assert measured.normwise.max() < 1e-17


def test_literals():
    assert LONG_DOUBLE.literal(0.5) == "0.5L"
    assert LONG_DOUBLE.literal(0.1) == "0.100000000000000005551115123125782702L"
    with mpmath.workprec(300):
        third = LONG_DOUBLE.literal(mpmath.mpf(1) / 3)
    assert third == f"0.{'3' * 36}L"
    assert np.longdouble(third[:-1]) == np.longdouble(1) / 3


@pytest.mark.parametrize("compiler", C)
def test_c_is_clean_and_runs(compiler, tmp_path):
    folder = source(precision=LONG_DOUBLE).write(tmp_path / "out")
    for file in ("handmade.c", "handmade_batch.c"):
        run(*C[compiler], "-std=c99", "-O2", *WARNINGS, "-c", file, folder=folder)
    undefined = {line.split()[-1] for line in run("nm", "-u", "handmade.o", folder=folder).splitlines()}
    assert undefined <= {"sinl", "cosl", "sincosl", "sqrtl"}
    flags = SANITIZERS if compiler == "gcc" else ["-O2"]
    run(
        *C[compiler],
        "-std=c99",
        *flags,
        *WARNINGS,
        "main.c",
        *code("handmade"),
        "-o",
        "example",
        folder=folder,
    )
    results = printed(run("./example", folder=folder, ASAN_OPTIONS="detect_leaks=0"))
    inputs = {"x": [0.1, 0.2], "y": [0.1, 0.2]}
    inputs["force"] = inputs["torque"] = [(1 + i % 7) / 10 for i in range(9)]
    inputs |= evaluate(module().prepare, parameters=[2.0, 0.75])
    for name, program in module().functions.items():
        for array, values in evaluate(program, **inputs).items():
            np.testing.assert_allclose(results[name, array], values, rtol=1e-14, err_msg=array)


def test_platforms_without_it_are_refused(monkeypatch):
    system = kg.load("models/cart_pole.toml")
    monkeypatch.setattr(build, "significand_bits", lambda dtype: 53)
    assert kg.build(system).n == 2
    with pytest.raises(
        BuildError, match=r"^precision 'long double': long double has 53 bits .* Use double-double"
    ):
        kg.build(system, precision="long double")


def test_compilers_without_it_are_refused():
    with pytest.raises(BuildError, match="long double has too few bits on this platform: generate another"):
        kg.build(kg.load("models/cart_pole.toml"), precision="long double", flags="-mlong-double-64")


def test_numbers_out_of_range():
    body = kg.Body("body", 0, 1e300, np.eye(3), mass_center=(1e10, 0, 0))
    with pytest.raises(ModelError, match="the mass is too large for the range of double precision"):
        kg.generate(kg.System("big", (body,)), precision="long double")


def test_the_command_line(tmp_path):
    kanegen("generate", PENDULUM, "-o", str(tmp_path / "out"), "--precision", "long double")
    header = (tmp_path / "out" / "double_pendulum.h").read_text().replace("\n *", "")
    assert "long double x[2]" in header
    assert "All is computed in long double, which has 64 bits or more" in header
    assert "passed" in kanegen("check", PENDULUM, "--states", "20", "--precision", "long double").stdout
