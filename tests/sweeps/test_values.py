"""Results of sweeps against SciPy on the NumPy reference, and against rollouts of one row after the other."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import kanegen as kg
from kanegen.reference import equations as reference
from kanegen.sweeps.bands import bins_of, quantile
from kanegen.sweeps.design import read_design
from kanegen.sweeps.plan import make_plan
from kanegen.sweeps.sampling import Sampling
from kanegen.sweeps.statistics import STATISTICS
from tests.support.paths import ROOT
from tests.support.sweeps import AXES, RESULTS, job, pendulum, swept

OUTPUTS = ("rollout_rk4", "kinetic_energy", "potential_energy")


@pytest.fixture(scope="module")
def found() -> kg.SweepResult:
    return swept()


def usable(found: kg.SweepResult) -> Any:
    table = found.table
    return table[table["reason"] == ""]


def test_rows_are_all_combinations(found: kg.SweepResult) -> None:
    table = found.table
    assert table.index.tolist() == list(range(48))
    assert table["m2"].tolist() == [0.5] * 16 + [1.0] * 16 + [-1.0] * 16
    q1 = table["x.q1"].to_numpy()
    assert (q1[:16] == q1[16:32]).all()
    assert len(set(q1[:16])) == 16
    assert found.results == ("end.x.q1", "end.x.q2", "max.y.q2", "drift.energy", "path.x.q1")


def test_a_motion_is_that_of_the_reference(found: kg.SweepResult) -> None:
    row = usable(found).iloc[20]
    system = pendulum().with_parameters({"m2": row["m2"]})

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        x, y = state[:2], state[2:]
        tau = np.array([0.0, 0.3 * row["m2"] * math.sin(2 * t)])
        f = np.asarray(reference.forcing(system, x, y))
        return np.concatenate([y, np.linalg.solve(np.asarray(reference.mass_matrix(system, x)), f + tau)])

    start = [row["x.q1"], row["x.q1"] / 2 + 0.1, 0.0, 0.0]
    end = solve_ivp(rates, (0.0, 0.4), start, "DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    # 40 steps of RK4 with step 0.01, whose local errors are of order (0.01 x rate of about 6/s)^5 / 120.
    assert np.abs(row[["end.x.q1", "end.x.q2"]].to_numpy(float) - end[:2]).max() < 40 * 0.06**5 / 12


def test_rows_have_the_bits_of_single_rollouts(found: kg.SweepResult) -> None:
    library = kg.build(pendulum(), OUTPUTS)
    times = np.arange(81) * 0.005
    for row, values in usable(found).iloc[::5].iterrows():
        own = library.with_parameters({"m2": values["m2"]})
        x = [values["x.q1"], values["x.q1"] / 2 + 0.1 * 1.0]
        tau = np.stack([np.zeros(81), 0.3 * values["m2"] * np.sin(2 * times)], axis=1)
        path = own.rollout(x, [0.0, 0.0], tau, steps=40, step=0.01, every=4, hold="quadratic")
        energy = own.kinetic_energy(path.x, path.y) + own.potential_energy(path.x)
        expected = [*path.x[-1], path.y[:, 1].max(), np.abs(energy - energy[0]).max()]
        assert values[list(found.results[:4])].tolist() == expected, row
        assert values["path.x.q1"].tolist() == path.x[:, 0].tolist()


def test_rows_without_a_model_have_a_reason(found: kg.SweepResult) -> None:
    assert list(found.reasons) == list(range(32, 48))
    assert set(found.reasons.values()) == {"body 'lower': mass m2 = -1.0 kg is negative."}
    assert found.table[list(found.results[:4])][32:].isna().all(axis=None)


def test_chunks_do_not_matter(found: kg.SweepResult) -> None:
    other = swept(chunk_rows=5, workers=3)
    for name in (*found.results, "reason"):
        np.testing.assert_array_equal(found.column(name), other.column(name))


def test_xarray_has_a_dimension_for_each_axis(found: kg.SweepResult) -> None:
    data = found.to_xarray()
    assert dict(data.sizes) == {"m2": 3, "sample": 16, "time": 11}
    assert data["end.x.q1"].attrs == {"units": "rad"}
    assert data["drift.energy"].attrs == {"units": "J"}
    assert data["x.q1"].dims == ("sample",)
    last = data["path.x.q1"].isel(time=-1)
    np.testing.assert_array_equal(last, data["end.x.q1"])
    assert float(data.time[-1]) == pytest.approx(0.4, rel=1e-15)


def test_bands_are_the_distribution_at_every_time(found: kg.SweepResult) -> None:
    band = found.bands("x.q1")
    paths = np.stack(usable(found)["path.x.q1"])
    assert (band.counts() == 32).all()
    least, greatest = band.extremes()
    assert (least == paths.min(axis=0)).all()
    assert (greatest == paths.max(axis=0)).all()
    shares = [0.1, 0.5, 0.9]
    ordered = np.sort(paths, axis=0)
    for share, values in zip(shares, band.quantiles(shares), strict=True):
        around = ordered[math.floor(share * 31)], ordered[math.ceil(share * 31)]
        room = np.max(np.abs(around), axis=0) / 128
        assert (np.abs(values - np.quantile(paths, share, axis=0)) <= room).all()
    assert (band.histogram(np.linspace(-4, 4, 17)).sum(axis=1) == 32).all()


@pytest.mark.parametrize("size", [1, 2, 5, 300])
def test_quantiles_of_bins_are_those_of_numpy(size: int) -> None:
    """Exact where no bin has two values; else off by a bin, with the ends exact."""
    shares = np.linspace(0, 1, 23)
    spread = np.random.default_rng(size).normal(size=size)
    for values, room in ((1.5 ** np.arange(-2.0, size % 300), 4 * 2.0**-52), (spread, 2.0**-7)):
        column = bins_of(values[:, None, None]).column(0, 0)
        found = [quantile(*column, share) for share in shares]
        around = [np.quantile(values, shares, method=one) for one in ("lower", "higher")]
        expected = np.quantile(values, shares)
        assert (np.abs(found - expected) <= room * np.abs(around).max(axis=0)).all()
        assert (found[0], found[-1]) == (values.min(), values.max())
    column = bins_of(np.full((size, 1, 1), 0.1)).column(0, 0)
    assert {quantile(*column, share) for share in shares} == {0.1}


def test_bands_larger_than_motions_are_warned_of(recwarn: pytest.WarningsRecorder) -> None:
    design = read_design(pendulum(), AXES, Sampling(2048))
    plans = [make_plan(pendulum(), design, job(20.0, every=every), "parquet", 64) for every in (10, 1)]
    assert [len(plan.manifest["bands"]) for plan in plans] == [1, 1]
    (warning,) = recwarn
    assert "counts at 2001 times in chunks of 64 rows have up to 209 MB, more than the 98.4 MB" in str(
        warning.message
    )


def test_reductions_of_results(found: kg.SweepResult) -> None:
    ends = usable(found)["end.x.q1"].to_numpy()
    assert found.extremes("end.x.q1") == (ends.min(), ends.max())
    np.testing.assert_array_equal(found.quantiles("end.x.q1", [0.25, 0.75]), np.quantile(ends, [0.25, 0.75]))
    counts, edges = found.histogram("end.x.q1", 4)
    assert counts.sum() == 32
    assert edges[0] == ends.min()
    assert found.quantiles("path.x.q1").shape == (3, 11)
    assert [one["name"] for one in found.summary()] == list(found.results[:4])


def test_statistics_over_time() -> None:
    """Each against NumPy on the path; 200 times are several blocks."""
    names = ("path.y.q1", *(f"{one}.y.q1" for one in ("end", "max", "min", "mean", "rms", "drift")))
    axes = {"m2": [0.7], "x.q1": [0.4, 2.5]}
    times_of = ("time_of_max.y.q1", "time_of_min.y.q1", "time_of_zero.y.q1")
    what = job(2.0, results=(*names, *times_of), every=1, bands=())
    table = kg.sweep(pendulum(), axes, what).table
    times = np.arange(201) * 0.01
    for _, row in table.iterrows():
        path = row["path.y.q1"]
        assert row["end.y.q1"] == path[-1]
        assert (row["max.y.q1"], row["min.y.q1"]) == (path.max(), path.min())
        assert row["mean.y.q1"] == pytest.approx(path.mean(), rel=0, abs=201 * 2**-53 * np.abs(path).max())
        assert row["rms.y.q1"] == pytest.approx(np.sqrt((path**2).mean()), rel=201 * 2**-53)
        assert row["drift.y.q1"] == np.abs(path - path[0]).max()
        assert row["time_of_max.y.q1"] == times[path.argmax()]
        assert row["time_of_min.y.q1"] == times[path.argmin()]
        assert path[0] == 0  # from rest, which is no zero
        places = np.flatnonzero(np.diff(np.sign(path[1:]))) + 1
        assert np.isnan(row["time_of_zero.y.q1"]) == (len(places) == 0)
        if len(places):
            assert times[places[0]] < row["time_of_zero.y.q1"] < times[places[0] + 1]


@pytest.mark.parametrize("text", [kg.RolloutJob.__doc__, (ROOT / "docs" / "sweep.md").read_text()])
def test_documents_name_all_statistics(text: str) -> None:
    assert [name for name in STATISTICS if f'"{name}"' not in text and f"`{name}`" not in text] == []


def test_times_of_zeros() -> None:
    """The first change of sign of the angle, in the first block of times and in later ones."""
    axes = {"m2": [0.7], "x.q1": [-0.4, 2.5, 3.1, 3.141]}
    found = kg.sweep(
        pendulum(), axes, job(2.0, results=("time_of_zero.x.q1", "path.x.q1"), every=1, bands=())
    )
    times = np.arange(201) * 0.01
    zeros = found.column("time_of_zero.x.q1")
    for zero, path in zip(zeros, found.column("path.x.q1"), strict=True):
        places = np.flatnonzero(np.diff(np.sign(path)))
        if len(places):
            assert times[places[0]] < zero < times[places[0] + 1]
            assert np.interp(zero, times, path) == pytest.approx(0, abs=1e-14)
        else:
            assert np.isnan(zero)
    assert zeros[0] < 0.64 < zeros[1]
    assert np.isnan(zeros[-1])


@pytest.mark.parametrize(
    ("values", "zero"),
    [
        ([0, 1, 2, 1, -1, 1], 3.5),
        ([0, 0, -2, -1, 3, 3], 3.25),
        ([1, 2, 0, 1, -1, 1], 2.0),
        ([0, 0, 0, 0, 0, 0], np.nan),
        ([0, 1, 2, 3, 4, 5], np.nan),
        ([0, 1e-170, -1e-170, 1, 1, 1], 1.5),
        ([0, 1, 1, np.nan, -1, 1], 4.5),
    ],
)
@pytest.mark.parametrize("size", [1, 2, 6])
def test_a_zero_is_none_of_the_start(values: list[float], zero: float, size: int) -> None:
    """Values in blocks of `size` times; those of a motion from rest begin with 0."""
    found, times = STATISTICS["time_of_zero"](), np.arange(6.0)
    for first in range(0, 6, size):
        part = slice(first, first + size)
        found.add(times[part], np.array(values, float)[None, part, None])
    np.testing.assert_array_equal(found.result(), [[zero]])


def test_variants_are_axes() -> None:
    axes = {"m2": [1.0], "x.q1": [0.3], "precision": ["double", "float"], "step": [0.01, 0.02]}
    found = kg.sweep(pendulum(), axes, job(results="end.x.q1", bands=(), every=1))
    data = found.to_xarray()["end.x.q1"]
    assert dict(data.sizes) == {"m2": 1, "x.q1": 1, "precision": 2, "step": 2}
    reference = float(data.sel(precision="double", step=0.01).squeeze())
    single = float(data.sel(precision="float", step=0.01).squeeze())
    coarse = float(data.sel(precision="double", step=0.02).squeeze())
    assert 0 < abs(single - reference) < 40 * 2**-23
    assert 0 < abs(coarse - reference) < 1e-6
    assert single == np.float32(single)


def test_outputs_without_a_motion() -> None:
    """Duration 0 evaluates outputs in the initial states."""
    what = kg.RolloutJob(0.0, 1.0, results=("end.mass_matrix", "end.kinetic_energy"))
    found = kg.sweep(pendulum(), {"m2, l2": [[1.0, 0.5], [2.0, 0.1]], "x.q2": 0.3, "y.q1": 1.0}, what)
    for _, row in found.table.iterrows():
        system = pendulum().with_parameters({"m2": row["m2"], "l2": row["l2"]})
        A = np.asarray(reference.mass_matrix(system, np.array([0.0, 0.3])))
        assert row["end.mass_matrix.q1.q2"] == pytest.approx(A[0, 1], rel=1e-14)
        assert row["end.kinetic_energy"] == pytest.approx(A[0, 0] / 2, rel=1e-14)
    assert found.to_xarray().sizes == {"m2, l2": 2, "x.q2": 1, "y.q1": 1}


def test_a_state_that_stops_being_finite() -> None:
    """The reason has the time and the last state; other rows stay as they are."""
    found = kg.sweep(
        pendulum(),
        {"m2": [1.0], "x.q1": [0.3], "y.q1": [0.0, 1e80]},
        job(results=("end.x.q1", "max.y.q1"), bands="x.q1"),
    )
    (reason,) = found.reasons.values()
    assert list(found.reasons) == [1]
    assert reason.startswith("in the step from t = 0 s, x.q1 = 0.3, x.q2 = 0, y.q1 = 1e+80, y.q2 = 0: ")
    assert np.isnan(found.column("end.x.q1")).tolist() == [False, True]
    assert found.bands("x.q1").counts()[[0, -1]].tolist() == [2, 1]


def test_results_that_are_not_finite_have_a_reason() -> None:
    """A state whose energy overflows; a time of a zero that there is not has no reason."""
    names = ("end.x", "end.energy", "time_of_zero.x.q1")
    what = kg.RolloutJob(0.0, 1.0, results=names)
    found = kg.sweep(pendulum(), {"m2": [1.0], "x.q1": [0.3], "y.q1": [1.0, 1e200]}, what)
    assert found.reasons == {1: "end.energy is not finite."}
    assert np.isfinite(found.column("end.energy")).tolist() == [True, False]
    what = kg.RolloutJob(0.0, 1.0, results="end.kinetic_energy")
    single = kg.sweep(pendulum(), {"y.q1": [1e30], "precision": ["double", "float"]}, what)
    assert single.reasons == {1: "end.kinetic_energy is not finite."}


def test_a_change_of_sign_of_tiny_values() -> None:
    """Their product is smaller than every number."""
    zero = STATISTICS["time_of_zero"]()
    zero.add(np.zeros(1), np.full((1, 1, 1), 1e-170))
    zero.add(np.array([1.0, 2.0]), np.array([[[3e-170], [-1e-170]]]))
    assert zero.result() == pytest.approx(1.75, rel=1e-15)


def test_pictures_of_results(found: kg.SweepResult, tmp_path: Path) -> None:
    assert repr(found).startswith("<SweepResult of double_pendulum: 48 of 48 rows, 16 with a reason, end.x")
    assert found.is_complete
    assert len(found) == 48
    assert RESULTS[0] == "end.x"
    assert set(AXES) <= {*found.table.columns, "tau.q2"}
