"""The reference with other units, locked freedoms, batches, separate terms and wrong shapes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

import kanegen as kg
from kanegen.errors import ArrayError
from kanegen.reference import equations as reference
from kanegen.reference.states import random_states, ranges
from tests.support import systems

EXAMPLES = settings(max_examples=40, deadline=None, derandomize=True)


@EXAMPLES
@given(systems.systems(max_bodies=5))
def test_powers_of_two_in_mass_length_and_time_change_no_bit(system: kg.System) -> None:
    mass, length, time = 2.0**40, 2.0**-23, 2.0**17
    arrays, state = system.values(), systems.random_state(system)
    scaled = systems.rescaled(arrays, mass, length, time)
    force_unit = mass * length / time**2
    units = np.where([freedom.is_angle for freedom in system.freedoms], 1.0, length)
    loads = [
        None if load is None else load * unit
        for load, unit in [(state.force, force_unit), (state.torque, force_unit * length)]
    ]
    x, y = state.x * units, state.y * (units / time)
    arm = length / units  # from the unit of force to that of f, and to that of A per mass
    a = reference.mass_matrix(system, state.x)
    np.testing.assert_array_equal(reference.mass_matrix(scaled, x), a * np.outer(arm, arm) * mass)
    f = reference.forcing(system, state.x, state.y, state.force, state.torque)
    np.testing.assert_array_equal(reference.forcing(scaled, x, y, *loads), f * arm * force_unit)


def test_ranges_of_states_have_the_scale_of_the_bodies() -> None:
    """In units that are smaller, numbers are larger: of translations with the length, of speeds with both."""
    plain = systems.random_system(np.random.default_rng(3), 4).values()
    length, time = 8.0, 2.0
    whole, scaled = ranges(plain), ranges(systems.rescaled(plain, 4.0, length, time))
    moves = whole.size != 1.0  # angles have the size 1
    assert moves.any()
    np.testing.assert_allclose(scaled.size[moves], length * whole.size[moves], rtol=1e-14)
    np.testing.assert_allclose(scaled.y[moves], length / time * whole.y[moves], rtol=1e-14)
    np.testing.assert_allclose(scaled.y[~moves], whole.y[~moves] / time, rtol=1e-14)


def test_locking_drops_rows_and_columns() -> None:
    rng = np.random.default_rng(11)
    full = systems.eight_body()
    arrays, state = full.values(), systems.random_state(full)
    free = systems.random_free(rng, 8)
    angles, translations = np.split(state.x, 2)
    values = np.hstack([angles.reshape(8, 3), translations.reshape(8, 3)])
    part = kg.System.from_arrays(
        arrays.connection, arrays.mass, arrays.inertia, arrays.mass_center, arrays.joint_position,
        free=free, locked=np.where(free, 0.0, values), loads=True,
    )  # fmt: skip
    kept = np.concatenate([free[:, :3].ravel(), free[:, 3:].ravel()])
    x, y = state.x[kept], state.y[kept]
    a = reference.mass_matrix(full, state.x)[np.ix_(kept, kept)]
    np.testing.assert_allclose(reference.mass_matrix(part, x), a, atol=1e-14 * np.abs(a).max())
    f = reference.forcing(full, state.x, np.where(kept, state.y, 0.0), state.force, state.torque)[kept]
    np.testing.assert_allclose(
        reference.forcing(part, x, y, state.force, state.torque), f, atol=1e-14 * np.abs(f).max()
    )


def test_a_batch_equals_its_states() -> None:
    system = systems.random_system(np.random.default_rng(2), 4, loads=True)
    batch = random_states(system, 3)
    assert batch.force is not None and batch.torque is not None
    a = reference.mass_matrix(system, batch.x)
    f = reference.forcing(system, batch.x, batch.y, batch.force, batch.torque)
    same = reference.forcing(system, batch.x, batch.y, batch.force[0], batch.torque)
    for b in range(3):
        np.testing.assert_allclose(a[b], reference.mass_matrix(system, batch.x[b]), rtol=1e-14, atol=1e-14)
        one = reference.forcing(system, batch.x[b], batch.y[b], batch.force[b], batch.torque[b])
        np.testing.assert_allclose(f[b], one, rtol=1e-13, atol=1e-13)
    np.testing.assert_array_equal(same[0], f[0])
    assert not np.array_equal(same[1], f[1])


def test_the_separate_terms_are_what_their_names_say() -> None:
    system = systems.eight_body()
    state = systems.random_state(system)
    terms = reference.forcing_terms(system, state.x, state.y, state.force, state.torque)
    still = reference.forcing(system, state.x, 0 * state.y)
    np.testing.assert_array_equal(terms.gravity, still)
    loaded = reference.forcing(system, state.x, 0 * state.y, state.force, state.torque)
    np.testing.assert_allclose(terms.loads, loaded - still, atol=1e-13 * np.abs(still).max())
    fast = reference.forcing_terms(system, state.x, 2 * state.y)
    for name in ("acceleration", "transport", "angular", "gyroscopic"):
        np.testing.assert_array_equal(getattr(fast, name), 4 * getattr(terms, name))
        assert np.abs(getattr(terms, name)).max() > 0.1


def test_a_slightly_skewed_joint_orientation_counts_as_a_rotation() -> None:
    """Otherwise the mass of a body would depend on the frame in which a force acts."""
    skewed = systems.random_rotation(np.random.default_rng(1)) + 1e-13
    system = kg.System.from_arrays(
        [0], [1.5], [np.eye(3)], [[0, 0, 0]], [[0, 0, 0]], [skewed], systems.flags(1, ["s1", "s2", "s3"])
    )
    np.testing.assert_allclose(reference.mass_matrix(system, np.zeros(3)), 1.5 * np.eye(3), atol=4e-15)


def test_wrong_shapes_are_refused() -> None:
    system = systems.chain(2, loads=True)
    good = np.zeros(2)
    with pytest.raises(ArrayError, match=r"x has shape \(3,\); expected \(2,\) or \(B, 2\)"):
        reference.mass_matrix(system, np.zeros(3))
    with pytest.raises(ArrayError, match=r"x has shape \(1, 1, 2\)"):
        reference.mass_matrix(system, np.zeros((1, 1, 2)))
    with pytest.raises(ArrayError, match=r"y has shape \(\)"):
        reference.forcing(system, good, 1.0)
    with pytest.raises(ArrayError, match=r"x has shape \(2,\) and y \(4, 2\); they must have as many states"):
        reference.forcing(system, good, np.zeros((4, 2)))
    with pytest.raises(ArrayError, match=r"force has shape \(3,\); expected \(2, 3\)\."):
        reference.forcing(system, good, good, force=np.zeros(3))
    with pytest.raises(ArrayError, match=r"torque has shape \(5, 2, 3\); expected \(2, 3\) or \(4, 2, 3\)"):
        reference.forcing(system, np.zeros((4, 2)), np.zeros((4, 2)), torque=np.zeros((5, 2, 3)))
