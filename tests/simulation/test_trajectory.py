"""Names and units of a motion, its outputs over time, and what other readers find in its files."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pyarrow.parquet
import pytest
import xarray

import kanegen as kg
from kanegen.reference import equations as reference
from kanegen.simulation import Trajectory
from kanegen.simulation.elements import elements
from tests.support.paths import MODELS

OUTPUTS = (
    "forward_dynamics",
    "coordinate_rates",
    "kinetic_energy",
    "potential_energy",
    "momentum",
    "body_poses",
    "frame_velocities",
    "point_positions",
    "point_accelerations",
    "mass_matrix",
)


@pytest.fixture(scope="module")
def library() -> kg.Library:
    return kg.build(kg.load(MODELS / "satellite.toml"), OUTPUTS, flags="-O0")


@pytest.fixture(scope="module")
def motion(library: kg.Library) -> Trajectory:
    return _motion(library, ())


@pytest.fixture(scope="module")
def motions(library: kg.Library) -> Trajectory:
    """Two states at once."""
    return _motion(library, (2,))


def _motion(library: kg.Library, batch: tuple[int, ...]) -> Trajectory:
    x = np.zeros((*batch, len(library.coordinate_names)))
    x[..., 0] = 1.0
    y = np.broadcast_to(np.linspace(0.1, 0.8, library.n), (*batch, library.n)).copy()
    y[..., 0] += np.arange(max(1, *batch, 1)) if batch else 0.0
    force = np.linspace(-2.0, 3.0, library.n)
    return kg.simulate(
        library, x, y, np.linspace(0, 1, 5), step=0.05, effort=lambda t, x, y: force * (1 + t) + 0 * y
    )


def test_columns_have_names_and_units(motion: Trajectory) -> None:
    units = motion.units
    assert motion.names[0] == "t"
    assert [units[name] for name in ("t", "x.bus.e0", "x.left_drive", "x.bus.s1")] == ["s", "1", "rad", "m"]
    assert [units[name] for name in ("y.bus.omega1", "y.bus.s1", "tau.bus.s1")] == ["rad/s", "m/s", "N"]
    assert units["momentum.angular.x"] == "kg m^2/s"
    assert units["body_poses.bus.axis_x.z"] == "1"
    assert units["body_poses.bus.origin.z"] == "m"
    assert units["frame_velocities.bus.angular.x"] == "rad/s"
    assert units["frame_velocities.bus.linear.x"] == "m/s"
    assert units["mass_matrix.left_drive.left_drive"] == "kg m^2"
    assert units["mass_matrix.left_drive.bus.s1"] == "kg m"
    assert units["mass_matrix.bus.s1.bus.s1"] == "kg"
    assert motion.columns().keys() == units.keys()


def test_outputs_of_other_systems_have_units_of_their_rows() -> None:
    system = kg.load(MODELS / "cart_pole.toml")
    library = kg.build(system, ("reaction_loads", "coordinate_rates", "forcing"), flags="-O0")
    found = {one.name: one.unit for name in library.outputs for one in elements(library.source, name)}
    for row in system.reaction_rows:
        assert found[f"reaction_loads.{row.name}"] == row.effort
    units = {"rad": "N m", "m": "N"}
    for freedom, name in zip(system.freedoms, system.freedom_names, strict=True):
        assert found[f"forcing.{name}"] == units[freedom.unit]
        assert found[f"coordinate_rates.{name}"] == f"{freedom.unit}/s"


def test_elements_are_those_of_the_outputs(motion: Trajectory, motions: Trajectory) -> None:
    for one in (motion, motions):
        tip = one.output("point_positions")[..., 0, 2]
        assert np.array_equal(one.output("point_positions.antenna.z"), tip)
        assert np.array_equal(one.output("body_poses.bus.origin.z"), one.output("body_poses")[..., 0, 3, 2])
        assert np.array_equal(one.output("momentum.angular.y"), one.output("momentum")[..., 4])
        assert np.array_equal(
            one.output("y.left_drive"), one.y[..., one.library.speed_names.index("left_drive")]
        )
        assert np.array_equal(one.output("t"), one.times)
        for name, values in one.columns().items():
            assert np.array_equal(values, one.output(name)), name


def test_accelerations_are_those_of_the_forces_that_acted(motion: Trajectory, motions: Trajectory) -> None:
    """Accelerations are not part of the state; the reference computes them from the recorded forces."""
    system = motion.library.source.system
    assert system is not None
    for row in (0, 3):
        force = np.linspace(-2.0, 3.0, motion.library.n) * (1 + motion.times[row])
        assert np.allclose(motion.output("tau.bus.s1")[row], force[-3])
        A, f = (
            equation(system, motion.x[row][None], *rest)[0]
            for equation, rest in (
                (reference.mass_matrix, ()),
                (reference.forcing, (motion.y[row][None],)),
            )
        )
        expected = np.linalg.solve(A, f + force)
        assert np.allclose(motion.output("forward_dynamics")[row], expected, rtol=1e-9, atol=1e-9)
    first = motions.output("point_accelerations")
    assert first.shape == (5, 2, 1, 3)
    assert np.allclose(first[:, 0], motion.output("point_accelerations"), rtol=1e-12, atol=1e-12)


def test_a_data_frame_has_all_columns(motion: Trajectory, motions: Trajectory) -> None:
    frame = motion.to_pandas()
    assert frame.index.name == "t"
    assert tuple(frame.columns) == motion.names[1:]
    assert frame.attrs["units"]["x.left_drive"] == "rad"
    assert np.array_equal(frame["x.left_drive"], motion.output("x.left_drive"))
    both = motions.to_pandas()
    assert both.index.names == ["state", "t"]
    for state in range(2):
        assert np.array_equal(both.loc[state]["kinetic_energy"], motions.output("kinetic_energy")[:, state])


def test_a_dataset_has_dimensions_with_names(motion: Trajectory, motions: Trajectory) -> None:
    one, both = motion.to_xarray(), motions.to_xarray()
    assert np.array_equal(one.x.sel(coordinate="left_drive"), motion.output("x.left_drive"))
    assert one.body_poses.dims == ("t", "frame", "row", "axis")
    assert float(one.body_poses.sel(frame="bus", row="origin", axis="z", t=1.0)) == pytest.approx(
        motion.output("body_poses.bus.origin.z")[-1]
    )
    assert both.x.dims == ("t", "state", "coordinate")
    assert one.mass_matrix.dims == ("t", "freedom", "mass_matrix_freedom")
    assert one.kinetic_energy.attrs["units"] == "J"
    assert one.attrs["model"] == motion.library.name


@pytest.mark.parametrize("which", ["motion", "motions"])
def test_files_hold_every_bit(which: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    motion = request.getfixturevalue(which)
    frame = motion.to_pandas().reset_index()
    for end in (".csv", ".parquet", ".nc", ".npz"):
        motion.save(tmp_path / f"motion{end}")
    with (tmp_path / "motion.csv").open(newline="") as file:
        head, *rows = csv.reader(file)
    assert head == list(frame.columns)
    assert np.array_equal(np.array(rows, float), frame.to_numpy(float))
    parquet = pandas.read_parquet(tmp_path / "motion.parquet")
    assert np.array_equal(parquet.to_numpy(float), frame.to_numpy(float))
    assert parquet.attrs["units"]["x.left_drive"] == "rad" and parquet.attrs["model"] == motion.library.name
    schema = pyarrow.parquet.read_schema(tmp_path / "motion.parquet")
    assert schema.field("x.left_drive").metadata[b"units"] == b"rad"
    with xarray.open_dataset(tmp_path / "motion.nc", engine="h5netcdf") as found:
        assert np.array_equal(found.x, motion.x)
        assert found.momentum.attrs["units"] == "kg m/s, kg m^2/s"
    with np.load(tmp_path / "motion.npz") as arrays:
        assert np.array_equal(arrays["body_poses"], motion.output("body_poses"))
        assert tuple(arrays["names"]) == motion.names


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("kinetik_energy", "has no 'kinetik_energy'. Did you mean 'kinetic_energy'?"),
        ("x.left_drvie", "Did you mean 'x.left_drive'?"),
        ("momentum.linear.w", "Known are 'momentum.linear.x'"),
        ("regularity", "has no 'regularity'. Ask for this output with outputs=('regularity',)"),
        ("frame_accelerations.bus.linear.x", "Ask for this output with outputs=('frame_accelerations',)"),
    ],
)
def test_unknown_names_have_suggestions(motion: Trajectory, name: str, message: str) -> None:
    with pytest.raises(kg.OptionError) as error:
        motion.output(name)
    assert message in str(error.value)


def test_files_that_cannot_be_written(motion: Trajectory, tmp_path: Path) -> None:
    with pytest.raises(kg.OptionError, match=r"motion.xls: there is no format '.xls'. Known are '.csv'"):
        motion.save(tmp_path / "motion.xls")
    with pytest.raises(kg.WriteError, match="cannot be written"):
        motion.save(tmp_path / "missing" / "motion.csv")
    assert not list(tmp_path.iterdir())


def test_a_picture_has_a_panel_for_each_unit_and_a_caption(motion: Trajectory, tmp_path: Path) -> None:
    figure: Any = motion.plot()
    assert [axes.get_ylabel() for axes in figure.axes] == ["1", "rad", "m", "rad/s", "m/s", "J"]
    drawn = {line.get_label(): line.get_ydata() for axes in figure.axes for line in axes.lines}
    assert np.array_equal(drawn["x.left_drive"], motion.output("x.left_drive"))
    assert "RK4, step 0.05 s; energy less work drifts by " in figure.get_supxlabel()
    assert [axes.get_ylabel() for axes in motion.plot("point_positions").axes] == ["m"]
    figure.savefig(tmp_path / "motion.svg")
    assert (tmp_path / "motion.svg").read_text().startswith("<?xml")


def test_momentum_stands_in_the_caption_where_nothing_acts_from_outside(library: kg.Library) -> None:
    x = np.zeros(len(library.coordinate_names))
    x[0] = 1.0
    free = kg.simulate(library, x, np.linspace(0.1, 0.8, library.n), [0.0, 0.5, 1.0], step=0.01)
    assert "; linear and angular momentum by " in free.caption
    linear, angular = free.momentum_drift()
    assert max(linear.largest, angular.largest) < 1e-10  # RK4 of steps of 0.01 s


def test_outputs_that_are_asked_for_stand_beside_energies_and_momentum(library: kg.Library) -> None:
    x = np.zeros(len(library.coordinate_names))
    x[0] = 1.0
    motion = kg.simulate(library, x, None, 0.1, step=0.05, outputs=("point_positions",))
    assert motion.outputs == ("kinetic_energy", "potential_energy", "momentum", "point_positions")
    with pytest.raises(kg.OptionError) as error:
        motion.output("energy")
    assert str(error.value).count("'kinetic_energy'") == 1
