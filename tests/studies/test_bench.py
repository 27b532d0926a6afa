"""Comparisons: programs that agree are timed, the others are named, and only a compiler is required."""

from __future__ import annotations

import importlib.util
import json
import sys
from collections.abc import Iterator
from dataclasses import replace
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import kanegen as kg
from kanegen import extras as optional
from kanegen.cli.app import app
from kanegen.errors import MissingError
from kanegen.library.native import compilers, selftest
from kanegen.measure.timing import Times
from kanegen.program.semantics import OWN_ROUNDING
from kanegen.reference.states import ActuatedStates, states_away_from_gimbal_lock
from kanegen.studies import bench
from kanegen.studies.bench import building, plot, table
from kanegen.studies.bench import settings as settings_module
from kanegen.studies.bench.compare import evaluate
from kanegen.studies.bench.comparison import KANEGEN, PYTHON, Absence, Comparison, Entry
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers import dynibo_peer, kanegen_peer, pydy_peer
from kanegen.studies.bench.peers.problem import Problem
from kanegen.studies.bench.peers.registry import participants
from kanegen.studies.bench.results import (
    DERIVATIVES,
    DYNAMICS,
    EQUATIONS,
    QUANTITIES,
    TOLERANCE,
    Task,
    difference,
)
from kanegen.studies.bench.settings import (
    CONTRACTED,
    CONTRACTED_AVX2,
    DEFAULT,
    DEFAULT_AVX2,
    PORTABLE,
    Setting,
    here,
)
from kanegen.studies.bench.states import read_states, without_loads_and_parameters, write_states
from tests.support import systems
from tests.support.command import kanegen
from tests.support.paths import MODELS

TWO_LINKS = systems.chain(2)
QUICK = bench.BenchOptions(states=40, rounds=2, seconds=0.0)
"""Options with more states than a batch holds, and no whole number of batches."""


def quiet(stage: str) -> None:
    """Ignore the stage."""


def own(system: kg.System, states: ActuatedStates, folder: Path) -> Participant:
    """Build the participant that is kanegen's C in its default setting."""
    problem = Problem(system, states, write_states(states, folder / "states"), folder)
    _, make = next(kanegen_peer.builders(problem))
    (participant,) = make()
    return participant


def with_driver(code: str, tmp_path: Path) -> Participant:
    """Return a participant whose driver is a line of Python."""
    task = Task("equations", EQUATIONS)
    return Participant("other", DEFAULT, (sys.executable, "-c", code), tmp_path / "states", (task,))


@pytest.fixture
def nothing_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hide all packages of peers, and cargo."""

    def files(name: str) -> None:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(dynibo_peer, "cargo", lambda: None)
    monkeypatch.setattr(metadata, "files", files)


FEW = (DEFAULT, CONTRACTED)
"""Compiler settings that are compiled here; the others differ in flags only."""


@pytest.fixture(scope="module", autouse=True)
def few_settings() -> Iterator[None]:
    """Compile in few settings."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kanegen_peer, "SETTINGS", FEW)
        yield


@pytest.fixture(scope="module")
def alone(few_settings: None) -> Comparison:
    return bench.compare(TWO_LINKS, QUICK, peers=())


def test_only_a_compiler_is_required(alone: Comparison) -> None:
    assert (alone.model, alone.n, alone.standard, alone.absences, alone.notes) == (
        "chain",
        2,
        KANEGEN,
        (),
        (),
    )
    names = {(entry.participant, entry.setting.name) for entry in alone.entries}
    assert names == {(KANEGEN, one.name) for one in FEW} | {(PYTHON, "default")}
    for entry in alone.entries:
        assert entry.error < TOLERANCE
        assert len(entry.times.rounds) == QUICK.rounds
        assert entry.times.least > 0


def test_batches_are_timed_beside_single_states(alone: Comparison) -> None:
    for quantity in QUANTITIES:
        one, many = (alone.best(KANEGEN, quantity, DEFAULT, batch) for batch in (False, True))
        assert one is not None
        assert many is not None
        assert (one.task.batch, many.task.batch) == (False, True)


def test_a_call_from_python_is_compared_with_the_same_c(alone: Comparison) -> None:
    call, code = alone.best(PYTHON, EQUATIONS), alone.best(KANEGEN, EQUATIONS, DEFAULT)
    assert call is not None
    assert code is not None
    assert alone.overhead(EQUATIONS) == call.median - code.median
    assert set(table.overheads(alone)) == {"A + f", "forward dynamics"}


def test_rows_of_one_setting_have_the_same_flags(alone: Comparison) -> None:
    flags = {(entry.setting.name, entry.setting.flags) for entry in alone.entries}
    assert len(flags) == len(FEW)


def test_loads_and_parameters_are_left_out_and_noted() -> None:
    crane = kg.load(MODELS / "gantry_crane.toml")
    changed, notes = without_loads_and_parameters(crane)
    assert not changed.parameters
    assert not any(body.loads for body in changed.bodies)
    np.testing.assert_array_equal(changed.values().mass, crane.values().mass)
    assert notes == (
        "loads are switched off: not everything that is timed takes them",
        "run-time parameters are constants, at their defaults: bridge_mass, trolley_mass, load_mass",
    )
    assert without_loads_and_parameters(changed) == (changed, ())


def test_wrong_results_are_not_timed(tmp_path: Path) -> None:
    states = states_away_from_gimbal_lock(TWO_LINKS, 3)
    heavier = replace(TWO_LINKS, bodies=tuple(replace(body, mass=2.0) for body in TWO_LINKS.bodies))
    correct = own(TWO_LINKS, states, tmp_path)
    wrong_mass = replace(own(heavier, states, tmp_path), name="wrong_mass")
    entries, absences = evaluate([correct, wrong_mass], 2, QUICK, quiet)
    assert not absences
    for entry in entries:
        assert entry.agrees == (entry.participant == KANEGEN)
        assert len(entry.times.rounds) == (QUICK.rounds if entry.agrees else 0)
    comparison = Comparison("chain", 2, tuple(entries))
    assert not comparison.agrees
    assert comparison.best("wrong_mass", EQUATIONS) is None
    assert [row[3] for row in table.rows(comparison, EQUATIONS) if row[0] == "wrong_mass"] == [
        "not timed"
    ] * 2


def test_a_derivative_is_compared_with_its_own_size() -> None:
    """Derivatives by {tau} may be a millionth of those by {x}; an error in them counts nevertheless."""
    right = np.ones((2, 2, 3, 2))
    right[:, :, 2] = 1e-6
    other = right.copy()
    other[1, 0, 2, 1] += 1e-12
    right, other = (values.reshape(2, 6, 2) for values in (right, other))
    assert difference(other, right, DERIVATIVES) == pytest.approx(1e-6)
    assert difference(right, right, DERIVATIVES) == 0.0


@pytest.mark.parametrize("wrong", [np.nan, np.inf, 1.0 + 1e-9])
def test_a_difference_in_one_place_is_seen(wrong: float) -> None:
    right = np.ones((4, 3, 2))
    other = right.copy()
    other[2, 1, 0] = wrong
    assert difference(right, right, EQUATIONS) == 0.0
    assert difference(other, right, EQUATIONS) > TOLERANCE


def test_matrix_and_forcing_are_measured_by_their_own_sizes() -> None:
    right = np.full((1, 3, 2), 4.0)
    right[:, -1] = 1e-1
    other = right.copy()
    other[:, -1] += 1e-5
    assert difference(other, right, EQUATIONS) == pytest.approx(1e-4)
    right[:, -1], other[:, -1] = 0.0, 1e-15
    assert difference(other, right, EQUATIONS) == pytest.approx(1e-15 / 4e-3)


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("raise SystemExit('no such joint')", "no such joint"),
        pytest.param("raise SystemExit(3)", "status 3", marks=pytest.mark.slow),
    ],
)
def test_a_driver_that_fails_is_left_out(code: str, reason: str, tmp_path: Path) -> None:
    correct = own(TWO_LINKS, states_away_from_gimbal_lock(TWO_LINKS, 2), tmp_path)
    entries, absences = evaluate([correct, with_driver(code, tmp_path)], 2, QUICK, quiet)
    assert {entry.participant for entry in entries} == {KANEGEN}
    assert absences == [Absence("other", f"its driver failed: {reason}")]


@pytest.mark.usefixtures("nothing_installed")
def test_missing_peers_are_named_and_left_out(tmp_path: Path) -> None:
    present, absences = participants(TWO_LINKS, states_away_from_gimbal_lock(TWO_LINKS, 2), tmp_path)
    assert {participant.name for participant in present} == {KANEGEN, PYTHON}
    reasons = {absence.name: absence.reason for absence in absences}
    assert reasons.pop("dynibo") == "there is no cargo, which builds it (https://rustup.rs)"
    packages = {"Pinocchio", "Pinocchio, CppADCodeGen", "CasADi", "MuJoCo", "SymPy + PyDy", "frax"}
    derivatives = {f"{name}, derivatives" for name in ("Pinocchio, CppADCodeGen", "CasADi")}
    assert set(reasons) == packages | derivatives
    for reason in reasons.values():
        assert reason.endswith("is not installed (pip install 'kanegen[bench]')")


@pytest.mark.usefixtures("nothing_installed")
def test_a_plot_needs_matplotlib(alone: Comparison) -> None:
    with pytest.raises(MissingError, match=r"package matplotlib is not installed .*kanegen\[bench\]"):
        plot.svg([alone])


def test_headers_that_a_package_does_not_have() -> None:
    with pytest.raises(MissingError, match=r"numpy has no pinocchio/aba\.hpp"):
        optional.headers("numpy", "pinocchio/aba.hpp")


def test_an_unknown_peer() -> None:
    with pytest.raises(kg.OptionError, match=r"unknown peer 'mujocco'.*mujoco"):
        bench.compare(TWO_LINKS, QUICK, peers=["mujocco"])


def test_sympy_is_not_tried_with_many_freedoms(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(pydy_peer, "require", Path)
    system = systems.chain(10)
    states = states_away_from_gimbal_lock(system, 1)
    ((name, make),) = pydy_peer.builders(Problem(system, states, tmp_path / "states", tmp_path))
    assert name == "SymPy + PyDy"
    with pytest.raises(MissingError, match="not tried with 10 freedoms, which are more than 9"):
        make()


def test_sympy_is_stopped_at_the_time_limit(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(pydy_peer, "require", Path)
    monkeypatch.setattr(pydy_peer, "TIME_LIMIT", 0.001)
    states = states_away_from_gimbal_lock(TWO_LINKS, 1)
    ((_, make),) = pydy_peer.builders(Problem(TWO_LINKS, states, tmp_path / "states", tmp_path))
    with pytest.raises(MissingError, match=r"did not finish in 0\.001 s"):
        make()


def test_a_compiler_that_fails_or_takes_too_long(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(MissingError, match=r"the compiler failed: .*error"):
        building.compiled("broken", {"broken.c": "int main(void) { return }"}, ())
    monkeypatch.setattr(building, "TIME_LIMIT", 0.0001)
    with pytest.raises(MissingError, match=r"the compiler took more than 0\.0001 s"):
        building.compiled("slow", {"slow.c": "int slow;"}, ())


def test_no_cxx_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CXX", "no-such-compiler -v")
    with pytest.raises(MissingError, match=r"no C\+\+ compiler no-such-compiler"):
        building.compiled("empty", {"empty.cpp": ""}, ())


def test_states_return_from_their_file(tmp_path: Path) -> None:
    states = states_away_from_gimbal_lock(TWO_LINKS, 7)
    again = read_states(write_states(states, tmp_path / "states"))
    for name in ("x", "y", "tau"):
        np.testing.assert_array_equal(getattr(again, name), getattr(states, name))
    assert np.abs(states.x).max() > 1  # hinges turn further than what stays clear of gimbal lock
    crane = systems.eight_body()
    assert np.abs(states_away_from_gimbal_lock(crane, 50).x).max() <= 1


def entry(participant: str, median: float, batch: bool = False) -> Entry:
    times = Times((median - 1, median, median + 2))
    return Entry(participant, CONTRACTED, Task("a", EQUATIONS, batch), 0.0, times)


def test_texts_of_ratios_and_reasons() -> None:
    absences = (Absence("A", "it rains"), Absence("B", "it snows"), Absence("C", "it rains"))
    comparison = Comparison(
        "m", 1, (entry("slow", 1200), entry("fast", 60.04), entry("slower", 2400)), absences
    )
    assert table.head(comparison, EQUATIONS)[-2] == "over slow"
    rows = [row[3:6] for row in table.rows(comparison, EQUATIONS)]
    assert rows == [
        ["1200", "1199-1202", "1.00"],
        ["60.0", "59.0-62.0", "1/20.0"],
        ["2400", "2399-2402", "2.00"],
    ]
    assert table.rows(comparison, DYNAMICS) == []
    assert table.left_out(comparison) == ["Left out: A and C: it rains.", "Left out: B: it snows."]
    assert table.overheads(comparison) == {}


def test_a_ratio_has_the_confidence_interval_of_its_rounds() -> None:
    """Of nine ratios the second smallest and the second largest bound the median with 96 per cent."""
    slow = replace(entry("slow", 1), times=Times(tuple(100.0 + k for k in range(9))))
    fast = replace(entry("fast", 1), times=Times((10.0,) * 9))
    assert table.ratio(fast, slow) == "1/10.4 (10.1-10.7)"
    assert table.ratio(slow, fast) == "10.40 (10.10-10.70)"
    assert table.ratio(slow, None) == "-"


def test_settings_name_the_vector_instructions(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Setting("contracted", (), "AVX-512").words == "contracted, AVX-512"
    assert Setting("contracted, AVX2", (), "AVX2").words == "contracted, AVX2"
    monkeypatch.setattr(settings_module, "widest", lambda: "AVX2")
    assert here((DEFAULT, DEFAULT_AVX2, CONTRACTED_AVX2)) == [DEFAULT]
    monkeypatch.setattr(settings_module, "widest", lambda: "AVX-512")
    assert here((DEFAULT, DEFAULT_AVX2)) == [DEFAULT, DEFAULT_AVX2]
    assert "-march=x86-64-v3" in DEFAULT_AVX2.flags
    assert "-march=x86-64-v3" in CONTRACTED_AVX2.flags


def test_the_default_setting_has_the_flags_of_a_library_that_is_built_here() -> None:
    """gcc 12.2 for a processor that fuses products and sums needs one flag more to keep the bits."""
    found = compilers.find()
    default, portable = here((DEFAULT, PORTABLE))
    own = selftest.sound_flags(found, kg.generate(TWO_LINKS))
    assert default.flags[1:] == own[1:], "tests build libraries at another level of optimisation"
    for setting in (default, portable):
        assert OWN_ROUNDING in selftest.properties(found, setting.flags)
    assert (default, portable) == (DEFAULT, PORTABLE), "their names make them the same"


@pytest.mark.usefixtures("nothing_installed")
def test_the_command(tmp_path: Path) -> None:
    model, out = tmp_path / "chain.toml", tmp_path / "out.json"
    TWO_LINKS.save(model)
    options = ["--rounds", "1", "--seconds", "0", "--states", "3", "--peer", "pydy", "--save", str(out)]
    with pytest.warns(kg.KanegenWarning, match="--save: 1 round will not do for --against"):
        done = CliRunner().invoke(app, ["bench", str(model), *options])
    assert done.exit_code == 0, done.output
    assert "chain: 2 freedoms, 3 random states, 1 x 0 s a task" in done.stdout
    assert "A call from Python takes beyond the C: A + f" in done.stdout
    assert "over kanegen: median ratio of the rounds to its fastest row" in done.stdout
    assert "left out: SymPy + PyDy, " in done.stderr
    assert "timing on 1 core, round 1 of 1" in done.stderr
    assert json.loads(out.read_text())["comparisons"][0]["standard"] == KANEGEN


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--peer", "drake"), "unknown peer 'drake'."),
        (("--plot", "a.png"), "--plot: a.png does not end in .svg."),
        (("--json", "nowhere/a.json"), "nowhere/a.json: cannot be written: No such file or directory."),
        (("--plot", "nowhere/a.svg"), "nowhere/a.svg: cannot be written: No such file or directory."),
        (("--json", "."), ".: cannot be written: "),
    ],
)
def test_the_command_with_wrong_options(options: tuple[str, ...], message: str, tmp_path: Path) -> None:
    TWO_LINKS.save(tmp_path / "chain.toml")
    done = kanegen("bench", str(tmp_path / "chain.toml"), *options, status=2)
    assert not done.stdout
    assert done.stderr.startswith(f"error: {message}")
