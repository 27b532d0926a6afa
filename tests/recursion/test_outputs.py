"""Outputs that are asked for: each costs what it needs, several share, and C, header and Python agree."""

from __future__ import annotations

from functools import cache
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.library.native import commands, compilers
from kanegen.program.count import count
from kanegen.recursion.outputs import DERIVATIVES, PRODUCTS, SECOND_DERIVATIVES, available
from tests.support import moving_bodies, systems
from tests.support.cases import slow_except
from tests.support.moving_bodies import READS_SPEEDS
from tests.support.paths import MODELS

NEW = tuple(READS_SPEEDS)


@cache
def system(seed: int = 3) -> kg.System:
    tree = systems.random_system(np.random.default_rng(seed), 4, loads=True)
    return tree.with_points({"tip": (4, (0.1, -0.2, 0.3)), "elbow": (2, (0.0, 0.4, 0.0))})


@cache
def cost(tree: kg.System, *outputs: str) -> int:
    """Return the number of operations of one program for all `outputs`."""
    return sum(compile_module(tree, outputs).operations.values())


ALONE = {
    "kinetic_energy": (317, 380, 48),
    "potential_energy": (110, 115, 48),
    "momentum": (543, 678, 48),
    "mass_center": (114, 123, 48),
    "body_poses": (193, 287, 48),
}


@pytest.mark.parametrize("name", ALONE)
def test_operations_of_eight_bodies_do_not_rise(name: str) -> None:
    counts = compile_module(systems.eight_body(), (name,)).operations
    assert (counts["add"], counts["multiply"], counts["sincos"]) <= ALONE[name]
    assert counts["divide"] == counts["sqrt"] == counts["prepare"] == 0


@pytest.mark.parametrize("pair", list(combinations(NEW, 2)), ids=" ".join)
def test_several_cost_less_than_one_after_the_other(pair: tuple[str, ...]) -> None:
    tree = system()
    assert cost(tree, *pair) < sum(cost(tree, name) for name in pair)


def test_outputs_share_subexpressions() -> None:
    """[A] shares composite bodies, {f} angular velocities, and the mass centre its height."""
    tree = systems.eight_body(loads=False)
    for new, old, spared in (
        ("mass_center", "mass_matrix", 200),
        ("kinetic_energy", "forcing", 220),
        ("potential_energy", "mass_center", 230),
        ("momentum", "mass_center", 200),
        ("kinetic_energy", "momentum", 300),
    ):
        assert cost(tree, new, old) <= cost(tree, new) + cost(tree, old) - spared, (new, old)


@pytest.mark.parametrize(
    "left_out",
    [(*DERIVATIVES, *PRODUCTS, *SECOND_DERIVATIVES), pytest.param((), marks=pytest.mark.slow)],
    ids=["no derivatives", "every output"],
)
@pytest.mark.parametrize("seed", slow_except(range(3), 1))
def test_a_function_costs_the_same_whatever_else_is_asked_for(seed: int, left_out: tuple[str, ...]) -> None:
    """The counts are equal for every output of a tree with points."""
    tree = system(seed)
    without = {"forward_dynamics", "error_estimate", "regularity", *left_out}
    names = [name for name in available(tree) if name not in without]
    every = compile_module(tree, names).module.functions
    for name in names:
        (alone,) = compile_module(tree, (name,)).module.functions.values()
        assert count(every[name]) == count(alone), name
        assert [a.name for a in every[name].inputs] == [a.name for a in alone.inputs]
        if name in NEW:
            assert [a.name for a in alone.inputs] == (["x", "y"] if READS_SPEEDS[name] else ["x"])


def test_parameters_are_prepared_once_for_all() -> None:
    """A function alone prepares what it needs; several share it, and none computes more in a state."""
    tree = kg.load(MODELS / "gantry_crane.toml")
    names = ("mass_matrix", "forcing", "potential_energy")
    together = compile_module(tree, names).module
    alone = [compile_module(tree, (name,)).module for name in names]
    assert together.prepare is not None
    for name, module in zip(names, alone, strict=True):
        (function,) = module.functions.values()
        assert count(together.functions[name]) == count(function), name
    prepared = [sum(count(module.prepare).values()) for module in alone if module.prepare]
    assert sum(count(together.prepare).values()) < sum(prepared)


@pytest.fixture(scope="module")
def library() -> kg.Library:
    return kg.build(system(), ("mass_matrix", "forcing", "inverse_dynamics", *NEW))


def test_one_state_and_many_in_c(library: kg.Library) -> None:
    x, y = np.random.default_rng(1).normal(size=(2, 37, library.n))
    expected = moving_bodies.expected(system().values(), x, y)
    together = library.evaluate(x, y, ydot=y)
    for name, reads_speeds in READS_SPEEDS.items():
        call = getattr(library, name)
        batch = call(x, y) if reads_speeds else call(x)
        size = np.abs(expected[name]).max()
        assert batch == pytest.approx(expected[name], abs=1e-13 * size), name
        assert getattr(together, name) == pytest.approx(batch, abs=1e-14 * size)
        for row in (0, 36):
            one = call(x[row], y[row]) if reads_speeds else call(x[row])
            assert isinstance(one, np.ndarray)
            assert one.shape == batch.shape[1:]
            assert one == pytest.approx(batch[row], abs=1e-14 * size)


def test_single_precision() -> None:
    tree = system()
    library = kg.build(tree, NEW, precision="float")
    x, y = np.random.default_rng(1).normal(size=(2, 21, library.n)).astype(np.float32)
    expected = moving_bodies.expected(tree.values(), x.astype(float), y.astype(float))
    for name, found in zip(NEW, library.evaluate(x, y), strict=True):
        assert found.dtype == np.float32
        assert found == pytest.approx(expected[name], abs=3e-6 * np.abs(expected[name]).max()), name
        assert getattr(library.evaluate(x[3], y[3]), name).dtype == np.float32


def test_speeds_are_required_where_outputs_depend_on_them(library: kg.Library) -> None:
    places = kg.build(system(), ("mass_center", "body_poses"))
    x = np.zeros(library.n)
    assert places.evaluate(x).mass_center.shape == (3,)
    with pytest.raises(kg.ArrayError, match="y: expected real numbers, got None"):
        library.evaluate(x, ydot=x)
    with pytest.raises(kg.ArrayError, match="y: expected shape"):
        library.kinetic_energy(x, x[1:])
    with pytest.raises(kg.OptionError, match="was built without the output 'momentum'"):
        places.momentum(x, x)


def test_the_header_documents_every_array() -> None:
    files = kg.generate(system(), NEW).files
    header, words = files["tree.h"], " ".join(files["tree.h"].split())
    n = len(system().freedoms)
    for prototype in (
        f"int tree_kinetic_energy(const double x[{n}], const double y[{n}], double kinetic_energy[1]);",
        f"int tree_potential_energy(const double x[{n}], double potential_energy[1]);",
        f"int tree_momentum(const double x[{n}], const double y[{n}], double momentum[6]);",
        f"int tree_mass_center(const double x[{n}], double mass_center[3]);",
        f"int tree_body_poses(const double x[{n}], double body_poses[4 * 4 * 3]);",
    ):
        assert prototype in header
    for unit in ("(J)", "(kg m/s, kg m^2/s)", "(m)", "(1, m)"):
        assert unit in words
    assert (
        "Outputs: kinetic_energy, potential_energy, momentum, mass_center, body_poses." in files["README.md"]
    )
    assert "body_poses[12*3 + 3*2 + 1] = " in files["tree.c"]


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 0.0), (0.0, 0.0, -9.81)])
def test_the_example_is_clean_and_runs(gravity: tuple[float, ...], tmp_path: Path) -> None:
    """One output is a constant, and arrays have one to three axes."""
    tree = systems.random_system(np.random.default_rng(7), 2, gravity=gravity)
    folder = kg.generate(tree, NEW).write(tmp_path / "out")
    flags = "-std=c99 -O0 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror".split()
    files = ("main.c", "tree.c", "tree_batch.c")
    commands.make([*compilers.find().command, *flags, *files, "-lm", "-o", "example"], "example", folder)
    printed = commands.output([folder / "example"])
    assert printed.count(" = ") == 2 * (1 + 1 + 6 + 3 + 2 * 4 * 3)
    assert ("potential_energy[0] = 0\n" in printed) == (not any(gravity))
