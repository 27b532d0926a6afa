"""Models computed in double-double, against certified truth; stored as doubles, correctly rounded."""

import re

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import ArrayError, BuildError, KanegenWarning, OptionError, SingularError
from kanegen.measure.truth import measure, truth
from kanegen.options import TIERS, Variant
from kanegen.program.precision import DOUBLE_DOUBLE
from kanegen.reference.states import random_states
from tests.support.c_compilers import CPP, SANITIZERS, WARNINGS, C, code, run
from tests.support.cases import slow_except
from tests.support.command import kanegen
from tests.support.handmade import bits, source
from tests.support.paths import PENDULUM
from tests.support.systems import flags, random_system

OUTPUTS = ("mass_matrix", "forcing", "forward_dynamics")
QUICK = ("-O0", "-ffp-contract=off")
SEPARATE = "-ffp-contract=off -fno-tree-slp-vectorize"
"""Flags with which products are rounded by themselves; gcc 12 fuses some in vectors in spite of the first."""

ALL_DOUBLE_DOUBLE = Variant(precision="double-double", storage="double-double")
ROUNDED = Variant(precision="double-double")


def tree(seed, bodies=3, **options):
    """Return a random tree with orientations, locked angles and loads."""
    return random_system(np.random.default_rng(seed), bodies, loads=True, **options)


def double_double(values):
    return np.stack([values, np.zeros_like(values)], axis=-1)


def exact(values):
    with mpmath.workprec(300):
        return [mpmath.mpf(float(a)) + mpmath.mpf(float(b)) for a, b in np.reshape(values, (-1, 2))]


@pytest.mark.parametrize("seed", slow_except((1, 2), 2))
def test_random_trees_have_thirty_digits(seed):
    """Errors stay below 1e-30 kappa_s: 2^-100, with room for the growth along the tree that the bound has."""
    system = tree(seed)
    found = measure(
        system, kg.build(system, OUTPUTS, flags=QUICK, tier=ALL_DOUBLE_DOUBLE), random_states(system, 3, seed)
    )
    for output, measured in found.items():
        assert measured.within_bound, output
        assert (measured.normwise <= 1e-30 * measured.kappa_s).all(), output
        assert (measured.normwise > 0).any()


@pytest.mark.slow
def test_eight_bodies_have_thirty_digits():
    system = kg.load("models/eight_body.toml")
    library = kg.build(system, ("mass_matrix", "forcing"), flags=QUICK, tier=ALL_DOUBLE_DOUBLE)
    for output, measured in measure(system, library, random_states(system, 1, 3)).items():
        assert measured.within_bound, output
        assert measured.normwise[0] <= 1e-30


@pytest.mark.parametrize("seed", slow_except((1, 3), 3))
def test_doubles_are_correctly_rounded(seed):
    """Results stored as doubles are the nearest doubles: off by half a unit in the last place."""
    system = tree(seed)
    library = kg.build(system, OUTPUTS, flags=QUICK, tier=ROUNDED)
    states = random_states(system, 4, seed)
    every = library.evaluate(states.x, states.y, states.force, states.torque)
    nearest = total = 0
    for b in range(len(states)):
        exact_ = truth(
            system, states.x[b], states.y[b], None, states.force[b], states.torque[b], outputs=OUTPUTS
        )
        for output in OUTPUTS:
            value = getattr(every, output)[b]
            assert value.dtype == np.float64
            distance, size = exact_[output].distance(value), np.abs(exact_[output].value)
            assert (distance <= 0.5000001 * np.spacing(size) + 1e-29 * size.max()).all()
            counted = (
                size > 1e-29 * size.max()
            )  # others are zero but for what is left of the model's rotations
            nearest += np.count_nonzero((value == exact_[output].value)[counted])
            total += np.count_nonzero(counted)
    assert nearest == total > 200


def test_constants_have_all_digits():
    """A rod locked at 0.3 rad: its sine and cosine, and what is computed from them, have 32 digits."""
    inertia = np.diag([0.0, 0.7, 0.7])
    system = kg.System.from_arrays(
        [0, 1], [0.9, 1.1], [inertia, inertia], [[0.3, 0, 0]] * 2, [[0, 0, 0], [0.7, 0, 0]],
        free=[[axis == 2 and k == 0 for axis in range(6)] for k in range(2)],
        locked=[[0] * 6, [0, 0, 0.3, 0, 0, 0]],
    )  # fmt: skip
    found = kg.build(system, "mass_matrix", flags=QUICK, tier=ALL_DOUBLE_DOUBLE).mass_matrix([[0.4, 0.0]])
    with mpmath.workprec(300):
        m, n, a, b, c = (mpmath.mpf(v) for v in (0.9, 1.1, 0.3, 0.7, 0.3))
        angle = mpmath.mpf(0.3)
        arm = (b + c * mpmath.cos(angle)) ** 2 + (c * mpmath.sin(angle)) ** 2
        expected = 2 * mpmath.mpf(0.7) + m * a**2 + n * arm
        (value,) = exact(found)
        assert abs(value - expected) / expected < mpmath.mpf(2) ** -106
    double = kg.build(system, "mass_matrix").mass_matrix([0.4])
    assert abs(double[0, 0] - float(expected)) < 4e-16 * float(expected)


def pendulum():
    return kg.System.from_arrays(
        [0], [2.0], [np.diag([0.1, 0.1, 0.1])], mass_center=[[0.5, 0.0, 0.0]], joint_position=[[0, 0, 0]],
        free=flags(1, ["theta3"]), gravity=(0.0, -8.0, 0.0),
    )  # fmt: skip


def test_angles_may_be_double_double():
    """{f} is -m g r cos x; near a right angle only the low part of x is left."""
    library = kg.build(pendulum(), "forcing", flags=QUICK, tier=ALL_DOUBLE_DOUBLE)
    with mpmath.workprec(300):
        for angle in (mpmath.mpf(1) / 3, mpmath.pi / 2, 1000 * mpmath.pi + mpmath.mpf(1) / 7):
            high = float(angle)
            x = (high, float(angle - high))
            (value,) = exact(library.forcing([x], [(0.0, 0.0)]))
            expected = -8 * mpmath.cos(mpmath.mpf(x[0]) + mpmath.mpf(x[1]))
            assert abs(value - expected) < abs(expected) * mpmath.mpf(2) ** -102


def test_arrays_of_pairs():
    system = tree(5)
    library = kg.build(system, ("forcing", "mass_matrix"), flags=QUICK, tier=ALL_DOUBLE_DOUBLE)
    assert (library.precision, library.storage) == ("double-double", "double-double")
    n, bodies = library.n, system.number_of_bodies
    rng = np.random.default_rng(2)
    x, y = rng.normal(size=(2, 4, n))
    force = rng.normal(size=(4, bodies, 3))
    batch = library.forcing(double_double(x), double_double(y), double_double(force))
    assert batch.shape == (4, n, 2)
    assert library.mass_matrix(double_double(x[0])).shape == (n, n, 2)
    for k in range(4):
        assert bits(
            library.forcing(double_double(x[k]), double_double(y[k]), double_double(force[k]))
        ) == bits(batch[k])
    assert bits(library.forcing(double_double(x), double_double(y), double_double(force[1]))[1]) == bits(
        batch[1]
    )
    with pytest.raises(ArrayError, match=rf"^x: expected shape \({n}, 2\) or \(B, {n}, 2\), got \({n},\)"):
        library.mass_matrix(x[0])


def test_the_interface_is_that_of_double():
    """With arrays of doubles, a program can take either library."""
    system = tree(5)
    sources = [kg.generate(system, OUTPUTS, tier=tier) for tier in ("strict", "exact")]
    first, second = (re.findall(r"^\w+ tree_.*?;", made.cdef, re.M | re.S) for made in sources)
    assert first == second
    assert len(first) == 8
    assert sources[1].variant == TIERS["exact"]
    assert {"kanegen_double_double.h", "tree.c", "tree_batch.c"} < sources[1].files.keys()
    assert not any("simd" in file or "sincos" in file for file in sources[1].files)


def test_what_parameters_make_is_not_rounded():
    """Masses and lengths that are run-time parameters keep as many digits as numbers in the code."""
    m, r = kg.Parameter("m", 0.3), kg.Parameter("r", 0.7)
    body = kg.Body("rod", 0, m, np.diag([0.1, 0.2, 0.2]), mass_center=(r, 0, 0))
    system = kg.System("swing", (body,))
    library = kg.build(system, OUTPUTS[:2], flags=QUICK, tier=ALL_DOUBLE_DOUBLE).with_parameters({"m": 1 / 3})
    states = random_states(system, 3, 1)
    for measured in measure(system, library, states).values():
        assert measured.within_bound
        assert (measured.normwise < 1e-30).all()


def test_what_does_not_exist_is_refused():
    system = pendulum()
    library = kg.build(system, ("forcing", "forward_dynamics"), flags=QUICK, tier=ROUNDED)
    assert np.isfinite(library.forcing([1e6], [0.0])).all()
    for x, why in ((1.1e6, "a number overflows"), (np.inf, r"x\[0\] is inf")):
        with pytest.warns(KanegenWarning, match=rf"^forcing: f\[0\] is nan, .*{why}"):
            assert np.isnan(library.forcing([x], [0.0])).all()
    gimbal = kg.System.from_arrays([0], [1.0], [np.eye(3)], [[0, 0, 0]], [[0, 0, 0]])
    locked = kg.build(gimbal, "forward_dynamics", flags=QUICK, tier=ROUNDED)
    with pytest.raises(SingularError, match=r"x\[1\] is nan"):
        locked.forward_dynamics([0, np.nan, 0, 0, 0, 0], np.zeros(6))


@pytest.mark.parametrize("choice", ["contracted", "reciprocal", "associative"])
def test_semantics_that_would_break_pairs_are_refused(choice):
    with pytest.raises(OptionError, match=r"^precision 'double-double' needs .*, which semantics .* give up"):
        Variant(precision="double-double", semantics=(choice,))


def test_flags_that_would_break_pairs_are_refused():
    with pytest.raises(BuildError, match=r"does not keep: .*order of sums.*, which this precision needs"):
        kg.build(pendulum(), tier="exact", flags="-O2 -ffast-math")


def test_storage():
    for precision, storage in (("double", "double-double"), ("double-double", "float")):
        message = rf"^storage '{storage}' does not go with precision '{precision}', which takes double"
        with pytest.raises(OptionError, match=message):
            Variant(precision=precision, storage=storage)
    with pytest.raises(OptionError, match=r"^unknown precision 'quad'"):
        Variant(storage="quad")


@pytest.mark.parametrize("storage", ["double", "double-double"])
@pytest.mark.parametrize("compiler", C)
def test_c_is_clean_and_needs_only_libm(compiler, storage, tmp_path):
    folder = source(precision=DOUBLE_DOUBLE, storage=storage).write(tmp_path / "out")
    for file in ("handmade.c", "handmade_batch.c", "main.c"):
        run(*C[compiler], "-std=c99", "-O1", *WARNINGS, "-c", file, folder=folder)
    undefined = {line.split()[-1] for line in run("nm", "-u", "handmade.o", folder=folder).splitlines()}
    assert undefined <= {"sqrt", "rint", "fma"}
    (folder / "user.cpp").write_text('#include "handmade.h"\nint main() { return HANDMADE_BODIES - 3; }\n')
    cpp = CPP[{"gcc": "g++", "clang": "clang++"}[compiler]]
    run(*cpp, "-std=c++98", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-c", "user.cpp", folder=folder)


def test_the_example_by_cmake_and_under_sanitizers(tmp_path):
    folder = source(precision=DOUBLE_DOUBLE, storage="double-double").write(tmp_path / "out")
    sanitized = ["-std=c99", "-O1", *SANITIZERS, "main.c", *code("handmade"), "-o", "example"]
    run(*C["gcc"], *sanitized, folder=folder)
    text = run("./example", folder=folder, ASAN_OPTIONS="detect_leaks=0")
    run("cmake", "-S", ".", "-B", "build", folder=folder)
    run("cmake", "--build", "build", "--target", "kanegen_handmade_example", folder=folder)
    assert run("build/kanegen_handmade_example", folder=folder) == text
    parts = re.search(r"^A\[1\] = (\S+) \+ (\S+)$", text, re.M).groups()
    with mpmath.workprec(300):
        (value,) = exact([[float(part) for part in parts]])
        expected = -2.5 * mpmath.cos(mpmath.mpf(0.1) - mpmath.mpf(0.2))
        assert abs(value - expected) < abs(expected) * mpmath.mpf(2) ** -103


@pytest.mark.parametrize("bodies", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_every_compiler_gives_the_same_bits(bodies):
    """The bits do not depend on compiler, optimisation or fused multiply-add."""
    system = tree(6, bodies)
    rng = np.random.default_rng(4)
    n = len(system.freedoms)
    x, y = double_double(rng.normal(size=(5, n))), double_double(rng.normal(size=(5, n)))
    found = set()
    for compiler in C.values():
        for level in ("-O0", "-O2", "-O3 -march=native"):
            library = kg.build(
                system, OUTPUTS, " ".join(compiler), f"{level} {SEPARATE}", tier=ALL_DOUBLE_DOUBLE
            )
            found.add(b"".join(value.tobytes() for value in library.evaluate(x, y)))
    assert len(found) == 1


def test_the_command_line(tmp_path):
    kanegen(
        "generate", PENDULUM, "-o", str(tmp_path / "out"), "--tier", "exact", "--storage", "double-double"
    )
    header = (tmp_path / "out" / "double_pendulum.h").read_text().replace("\n *", "")
    assert "kanegen_double_double x[2]" in header
    assert "All is computed in double-double, about 32 digits" in header
    text = kanegen("check", PENDULUM, "--states", "20", "--precision", "double-double").stdout
    assert "passed" in text and "2^-53" in text


def test_literals():
    assert DOUBLE_DOUBLE.literal(0.5) == "dd_of(0.5)"
    with mpmath.workprec(300):
        third = mpmath.mpf(1) / 3
        assert DOUBLE_DOUBLE.literal(third) == "dd_literal(0.3333333333333333, 1.850371707708594e-17)"
