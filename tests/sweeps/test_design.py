"""Rows, samples and formulas of sweeps, and what is refused before anything is computed."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import qmc

import kanegen as kg
from kanegen.sweeps.design import Design, read_design
from tests.support.paths import MODELS
from tests.support.sweeps import job, pendulum


def design(axes: Any, **sampling: Any) -> Design:
    return read_design(pendulum(), axes, kg.Sampling(**{"count": 8, **sampling}))


def test_the_last_axis_changes_fastest() -> None:
    found = design({"m1": [1, 2], "precision": ["double", "float"], "x.q1": [0.1, 0.2, 0.3]})
    assert found.rows == 12
    assert [one["precision"] for one in found.combinations] == ["double", "float"]
    columns = found.columns(0, found.rows_of_variant)
    assert columns["m1"].tolist() == [1, 1, 1, 2, 2, 2]
    assert columns["x.q1"].tolist() == [0.1, 0.2, 0.3] * 2
    part = found.columns(4, 6)
    assert (part["m1"].tolist(), part["x.q1"].tolist()) == ([2, 2], [0.2, 0.3])


def test_values_between_two_ends() -> None:
    found = design(
        {"m1": {"from": 1, "to": 3, "count": 5}, "m2": {"from": 0.1, "to": 10, "count": 3, "spacing": "log"}}
    )
    columns = found.columns(0, found.rows)
    assert columns["m1"][::3].tolist() == [1, 1.5, 2, 2.5, 3]
    assert columns["m2"][:3] == pytest.approx([0.1, 1, 10], rel=1e-15)


def test_axes_that_go_together() -> None:
    found = design({("m1", "m2"): np.array([[1, 2], [3, 4]]), "l1": [5, 6]})
    columns = found.columns(0, 4)
    assert columns["m1"].tolist() == [1, 1, 3, 3]
    assert columns["m2"].tolist() == [2, 2, 4, 4]
    assert columns["l1"].tolist() == [5, 6, 5, 6]


ENGINES: dict[str, Callable[[int, Any], Any]] = {
    "sobol": lambda axes, rng: qmc.Sobol(axes, rng=rng).random(8),
    "halton": lambda axes, rng: qmc.Halton(axes, rng=rng).random(8),
    "latin_hypercube": lambda axes, rng: qmc.LatinHypercube(axes, rng=rng).random(8),
    "random": lambda axes, rng: rng.random((8, axes)),
}


@pytest.mark.parametrize("method", ENGINES)
def test_samples_are_those_of_scipy(method: str) -> None:
    axes = {"m1": {"uniform": [1, 3]}, "m2": {"log_uniform": [0.1, 10]}, "x.q1": {"normal": [2, 0.5]}}
    columns = design(axes, method=method, seed=5).columns(0, 8)
    shares = ENGINES[method](3, np.random.default_rng(5))
    assert columns["m1"] == pytest.approx(1 + 2 * shares[:, 0], rel=1e-15)
    assert columns["m2"] == pytest.approx(10 ** (2 * shares[:, 1] - 1), rel=1e-14)
    from scipy.stats import norm  # noqa: PLC0415 - slow to import

    assert columns["x.q1"] == pytest.approx(norm.ppf(shares[:, 2], 2, 0.5), rel=1e-13)


def test_formulas_follow_from_each_other() -> None:
    found = design({"x.q2": "y.q1/2", "y.q1": "3*m1 + x.q1 + l2", "m1": [1.0, 2.0]})
    columns = found.columns(0, 2)
    assert columns["y.q1"].tolist() == [3.7, 6.7]
    assert columns["x.q2"].tolist() == [1.85, 3.35]


def test_an_axis_has_one_value_where_it_is_a_number() -> None:
    assert design({"m1": 2.5}).columns(0, 1)["m1"].tolist() == [2.5]


@pytest.mark.parametrize(
    ("axes", "message"),
    [
        ({"m3": 1.0}, "axes: there is no 'm3'. Known are 'g', 'm1', 'l1', 'm2', 'l2', 'x.q1',"),
        ({"x.g1": 1.0}, "axes: there is no 'x.g1'. Known are "),
        ({"presicion": "float"}, "axes: there is no 'presicion'. Did you mean 'precision'?"),
        ({"m1": []}, "axes: m1: there is no value. Give one at least."),
        ({"m1": [1.0, "heavy"]}, "axes: m1: 'heavy' is not a number."),
        ({"m1": [1.0, float("nan")]}, "axes: m1: nan is not finite."),
        ({"m1": True}, "axes: m1: True is not a number."),
        (
            {"m1": {"uniform": [2.0, 1.0]}},
            "axes: m1: uniform: the lower end 2.0 is not below the upper end 1.0.",
        ),
        ({"m1": {"uniform": [2.0]}}, "axes: m1: uniform takes two numbers, got [2.0]."),
        ({"m1": {"normal": [0.0, 0.0]}}, "axes: m1: normal: the standard deviation 0.0 is not positive."),
        ({"m1": {"log_uniform": [0.0, 1.0]}}, "axes: m1: log_uniform: the lower end 0.0 is not positive."),
        ({"m1": {"unifrom": [0.0, 1.0]}}, "axes: m1: unknown key 'unifrom'. Did you mean 'uniform'?"),
        ({"m1": {"from": 1.0, "to": 2.0}}, "axes: m1: 'count' is missing."),
        ({"m1": {"from": 1.0, "to": 2.0, "count": 0}}, "axes: m1: count: 0 is no whole number from 1"),
        ({"m1": {"from": -1.0, "to": 2.0, "count": 3, "spacing": "log"}}, "two ends of one sign"),
        ({"m1, m2": [[1.0]]}, "axes: m1, m2: row 0 is [1.0], not 2 numbers."),
        ({"m1": 1.0, "m1, m2": [[1.0, 2.0]]}, "axes: 'm1' stands there twice. Name it once."),
        ({"m1, step": [[1.0, 0.1]]}, "variants stand alone"),
        ({"x.q1": "2*m9"}, "axes: x.q1: expression 'm9' in expression '2*m9': the name is not known."),
        ({"x.q1": "x.q3"}, "axes: x.q1: there is no 'x.q3'."),
        ({"x.q1": "x.q2", "x.q2": "x.q1"}, "axes: x.q1, x.q2 follow from each other in a circle."),
        ({"x.q1": "sin(t)"}, "axes: x.q1: only inputs such as tau.q1 depend on t."),
        ({"x.q1": "__import__('os')"}, "there is no function '__import__'"),
        ({"force.upper.x": 1.0}, "axes: there is no 'force.upper.x'."),
        (
            {f"{k}": {"from": 1, "to": 2, "count": 1000} for k in ("m1", "m2", "l1")},
            "1000000000 rows are more",
        ),
        ([1.0], 'axes: [1.0] is no table of axes such as {"m1": [1.0, 2.0]}.'),
        ({7: 1.0}, "axes: 7 is no name of an axis."),
    ],
)
def test_axes_that_are_refused(axes: Any, message: str) -> None:
    with pytest.raises(kg.OptionError) as caught:
        design(axes)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"step": 0.3, "duration": 1.0},
            "job: duration: 1.0 s is no whole number of steps of 0.3 s. Take 0.9 s",
        ),
        ({"step": 0.0}, "job: step: 0.0 s is not positive."),
        ({"duration": -1.0}, "job: duration: -1.0 s is negative."),
        ({"duration": "long"}, "job: duration: 'long' is not a number."),
        ({"step": 1e-12}, "job: more than 1000000000 steps."),
        ({"every": 3}, "job: every: 40 steps are no multiple of 3."),
        ({"every": 0}, "job: every: 0 is no positive number of steps."),
        ({"method": "rk5"}, "unknown method 'rk5'."),
        ({"results": ()}, "job: results: none is named."),
        ({"results": "x.q1"}, "job: results: 'x.q1' does not begin with a statistic, such as 'end.x'."),
        ({"results": "maxx.x.q1"}, "Did you mean 'max'?"),
        ({"results": 5}, "job: results: expected names, got 5."),
    ],
)
def test_jobs_that_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(kg.OptionError) as caught:
        job(**{"bands": (), "every": 1, **changes})
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"job": 5}, "job: 5 is no job. Make one with kg.RolloutJob(duration, step)."),
        ({"system": "arm.toml"}, "system: 'arm.toml' is no system."),
        ({"format": "csv"}, "unknown format 'csv'. Known are 'parquet', 'zarr'."),
        ({"samples": 0}, "samples: count: 0 is no whole number from 1 to"),
        ({"samples": {"method": "sobel"}}, "unknown method of sampling 'sobel'. Did you mean 'sobol'?"),
        ({"samples": {"number": 5}}, "samples: there is no 'number'."),
        ({"workers": 0}, "workers: 0 is no number of threads"),
        ({"executor": 5}, "executor: 5 runs nothing."),
        (
            {"executor": "cluster"},
            "executor: 'cluster' is neither 'mpi' nor the address of a scheduler of Dask",
        ),
        ({"workers": 2, "executor": "mpi"}, "workers: the number of threads goes with no other executor."),
        ({"chunk_rows": 0}, "chunk_rows: 0 is no number of rows from 1"),
        ({"axes": {"m2": 1.0, "precision": "half"}}, "unknown precision 'half'"),
        ({"axes": {"m2": 1.0, "tier": "exact", "storage": "double-double"}}, "Take storage 'double'."),
        (
            {"axes": {"m2": 1.0, "step": [0.01, 0.03]}},
            "job: duration: 0.4 s is no whole number of steps of 0.03",
        ),
        (
            {"job": job(results="end.enrgy")},
            "job: results: there is no quantity 'enrgy'. Did you mean 'energy'?",
        ),
        ({"job": job(results="end.x.q7")}, "job: results: there is no quantity 'x.q7'."),
        ({"job": job(results="end.point_positions")}, "there is no quantity 'point_positions'"),
        ({"axes": {"m2": 1.0, "step": [0.01, 0.02]}}, "need the same number of times in all variants"),
    ],
)
def test_options_that_are_refused(options: dict[str, Any], message: str) -> None:
    given: dict[str, Any] = {"system": pendulum(), "axes": {"m2": 1.0}, "job": job(), **options}
    with pytest.raises(kg.OptionError) as caught:
        kg.sweep(**given)
    assert message in str(caught.value)


def test_unbalanced_sobol_points_give_a_warning() -> None:
    with pytest.warns(kg.KanegenWarning, match=r"6 Sobol points do not cover .*such as 8\."):
        design({"m1": {"uniform": [1.0, 2.0]}}, count=6)


def test_a_parameter_with_the_name_of_a_variant() -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    body = system.bodies[0]
    renamed = kg.System(
        "one", (kg.Body("a", 0, kg.Parameter("step", 1.0), body.inertia, (1, 0, 0), body.joint),)
    )
    with pytest.raises(kg.OptionError, match=r"'step' is a parameter and a variant\."):
        read_design(renamed, {"step": 1.0}, kg.Sampling())


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("row", "a column of every table"),
        ("reason", "a column of every table"),
        ("sample", "a dimension of results"),
        ("step", "a variant"),
    ],
)
def test_parameters_whose_names_are_taken(name: str, what: str, tmp_path: Path) -> None:
    text = (MODELS / "double_pendulum.toml").read_text()
    (tmp_path / "p.toml").write_text(re.sub(r"\bm2\b", name, text))
    system = kg.load(tmp_path / "p.toml")
    for axes in ({name: [0.5, 1.0]}, {f"m1, {name}": [[0.5, 1.0]]}):
        with pytest.raises(kg.OptionError) as caught:
            read_design(system, axes, kg.Sampling())
        assert str(caught.value) == f"axes: {name!r} is a parameter and {what}. Rename the parameter."


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"results": ("end.x", "end.x.q1")}, "job: results: 'end.x.q1' stands there twice, alone and in an"),
        ({"bands": ("x", "x.q2")}, "job: bands: 'x.q2' stands there twice, alone and in an array."),
    ],
)
def test_numbers_that_are_asked_for_twice(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(kg.OptionError) as caught:
        kg.sweep(pendulum(), {"x.q1": [0.1]}, job(**changes))
    assert message in str(caught.value)
