"""Loops that Numba compiles call generated functions by address, with the bits of the library."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.options import Variant
from kanegen.reference.states import random_states
from tests.support.pages import blocks
from tests.support.paths import MODELS, ROOT

pytestmark = pytest.mark.embed("numba")

QUICK = "-O1 -ffp-contract=off"


@pytest.fixture(scope="module")
def page() -> dict[str, Any]:
    """What the blocks of the page have defined."""
    namespace: dict[str, Any] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        for block in blocks("embedding/numba", "python"):
            exec(block, namespace)
    return namespace


def test_a_motion_in_a_compiled_loop(page: dict[str, Any]) -> None:
    """The same method in C sums in another order, and 10000 steps of 1e-16 are 1e-12."""
    library = kg.build(kg.load(MODELS / "double_pendulum.toml"), ("rollout_rk4",), flags=QUICK)
    rollout = library.rollout([0.3, 0.2], [0.0, 0.0], steps=10_000, step=1e-3, every=10_000)
    assert np.abs(page["end"] - [*rollout.x[-1], *rollout.y[-1]]).max() <= 1e-10
    assert page["failed"] == 0
    _, failed = page["rk4"](page["pendulum"].prepared, np.full(4, np.nan), np.zeros(2), 1e-3, 3)
    assert failed == 12


def test_one_state(page: dict[str, Any]) -> None:
    x, y, tau = np.random.default_rng(1).normal(size=(3, 7))
    status, found = page["accelerations"](x, y, tau)
    assert status == 0
    assert found.tolist() == page["library"].forward_dynamics(x, y, tau).tolist()


def test_many_states_in_parallel(page: dict[str, Any]) -> None:
    x, y, tau = np.random.default_rng(2).normal(size=(3, 200, 2))
    x[17, 0] = np.inf
    pendulum, found = page["pendulum"].with_on_status("ignore"), np.empty((200, 2))
    assert page["accelerations_of_many"](pendulum.prepared, x, y, tau, found) == pendulum.n + 1
    assert np.array_equal(found, pendulum.forward_dynamics(x, y, tau), equal_nan=True)


def test_a_ufunc_of_numba(page: dict[str, Any]) -> None:
    x, y, tau = np.random.default_rng(3).normal(size=(3, 4, 5, 7))
    own = page["library"].ufunc("forward_dynamics")
    for given in ((x, y, tau), (x.transpose(1, 0, 2), y[:, 0], tau[0, 0]), (x[..., ::-1], y, tau)):
        assert np.array_equal(page["dynamics"](*given), own(*given))


def test_a_batch_with_quaternions_loads_and_single_precision() -> None:
    numba = importlib.import_module("numba")
    system = kg.load(MODELS / "satellite.toml")
    library = kg.build(system, ("forward_dynamics",), tier=Variant("float"), flags=QUICK)
    batch = library.c_function("forward_dynamics_batch")

    @numba.njit  # type: ignore[untyped-decorator]
    def many(x: Any, y: Any, tau: Any, force: Any, torque: Any, found: Any) -> Any:
        return batch(len(x), x.ctypes, y.ctypes, tau.ctypes, force.ctypes, torque.ctypes, found.ctypes)

    states = random_states(system, 9, 4)
    arrays = [states.x, states.y, np.zeros((9, library.n)), states.force, states.torque]
    given = [np.ascontiguousarray(one, np.float32) for one in arrays]
    found = np.empty((9, library.n), np.float32)
    assert many(*given, found) == 0
    assert np.array_equal(found, library.forward_dynamics(*given))
    with pytest.raises(numba.core.errors.TypingError):
        many(*(one.astype(float) for one in given), found)
