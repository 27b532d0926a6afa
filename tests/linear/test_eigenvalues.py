"""Eigenvalues, modes, controllability and observability of given matrices."""

from __future__ import annotations

import numpy as np
import pytest

from kanegen.linear.controllability import controllable, observable
from kanegen.linear.eigenvalues import balanced, eigenvalues
from kanegen.linear.modes import modes_of, stability_of


def oscillator(K: list[list[float]], D: list[list[float]]) -> np.ndarray:
    """Return [A] of {ydot} = [K]{x} + [D]{y}."""
    n = len(K)
    return np.block([[np.zeros((n, n)), np.eye(n)], [np.array(K, float), np.array(D, float)]])


def modes(A: np.ndarray) -> tuple:
    n = len(A) // 2
    return modes_of(eigenvalues(A, n), [f"q{k}" for k in range(n)], slice(0, n))


def test_a_damped_oscillator() -> None:
    """Natural frequency 5 rad/s and damping ratio 0.1 by the formulas of a textbook."""
    (mode,) = modes(oscillator([[-25.0]], [[-1.0]]))
    assert mode.natural_frequency == pytest.approx(5 / (2 * np.pi), rel=1e-14)
    assert mode.damping_ratio == pytest.approx(0.1, rel=1e-14)
    assert mode.frequency == pytest.approx(5 * np.sqrt(1 - 0.01) / (2 * np.pi), rel=1e-14)
    assert mode.kind == "damped oscillation"
    assert stability_of([mode]).verdict == "asymptotically stable"


def test_undamped_eigenvalues_have_no_real_part() -> None:
    K = np.array([[-3.0, 1.0], [1.0, -3.0]])
    found = eigenvalues(oscillator(K.tolist(), [[0, 0], [0, 0]]), 2)
    assert (found.values.real == 0).all()
    assert sorted(found.values.imag) == pytest.approx([-2, -np.sqrt(2), np.sqrt(2), 2], rel=1e-14)
    assert stability_of(modes(oscillator(K.tolist(), [[0, 0], [0, 0]]))).verdict == "undecided"


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_what_slides_freely_is_neutral(damping: float) -> None:
    """A free coordinate beside an oscillator: two eigenvalues of 0 with one eigenvector, none grows."""
    rng = np.random.default_rng(1)
    turn, _ = np.linalg.qr(rng.normal(size=(2, 2)))
    K = turn @ np.diag([0.0, -4.0]) @ turn.T
    D = turn @ np.diag([0.0, -damping]) @ turn.T
    found = modes(oscillator(K.tolist(), D.tolist()))
    assert all(mode.growth <= 0 for mode in found)
    assert sum(mode.kind == "neutral" for mode in found) == 2
    assert stability_of(found).verdict == "undecided"


@pytest.mark.parametrize("seed", range(5))
def test_errors_bound_what_rounding_does(seed: int) -> None:
    """Random matrices with known eigenvalues, two of them close: the computed ones are within bounds."""
    rng = np.random.default_rng(seed)
    exact = np.array([-1.0, -1.0 - 10.0 ** -(seed + 3), 2.0, 0.5, -30.0])
    V = rng.normal(size=(5, 5))
    found = eigenvalues(V @ np.diag(exact) @ np.linalg.inv(V))
    distance = np.abs(found.values[:, None] - exact).min(axis=1)
    # [A] itself is formed with about cond(V) roundoffs, for which the bounds do not know.
    assert (distance <= found.errors * np.linalg.cond(V)).all()


@pytest.mark.parametrize("damping", [0.0, -0.5])
def test_uncertain_entries_count(damping: float) -> None:
    """An entry of 1e-16 that may be zero makes no growth of 1e-8 1/s; one that is known does."""
    A = oscillator([[1e-16, 0.0], [0.0, -4.0]], [[0.0, 0.0], [0.0, damping]])
    entries = np.zeros_like(A)
    entries[2, 0] = 3e-16
    names, places = ["a", "b"], slice(0, 2)
    unknown = modes_of(eigenvalues(A, 2, entries), names, places)
    assert [mode.kind for mode in unknown].count("neutral") == 2
    assert stability_of(unknown).verdict == "undecided"
    A[2, 0] = 1e-4
    known = modes_of(eigenvalues(A, 2, entries), names, places)
    assert known[0].growth == pytest.approx(1e-2, rel=1e-9)


def test_balancing_keeps_eigenvalues() -> None:
    A = np.array([[1.0, 1e6], [1e-6, 3.0]])
    B = balanced(A)
    assert np.linalg.norm(B, 2) < 10
    assert np.sort(np.linalg.eigvals(B)) == pytest.approx(np.sort(np.linalg.eigvals(A)), rel=1e-12)


def test_controllable_part() -> None:
    """Kalman's example: of two equal oscillators side by side, one force moves only the sum."""
    A = oscillator([[-4.0, 0.0], [0.0, -4.0]], [[0, 0], [0, 0]])
    one = controllable(A, np.array([[0.0], [0.0], [1.0], [1.0]]))
    assert (one.dimension, one.is_complete) == (2, False)
    assert sorted(value.imag for value in one.remaining) == pytest.approx([-2, 2])
    assert "no input moves the eigenvalues" in one.words("controllable", "no input moves")
    A[2, 0] = -4.1
    assert controllable(A, np.array([[0.0], [0.0], [1.0], [1.0]])).is_complete
    assert observable(A, np.array([[1.0, 0.0, 0.0, 0.0]])).dimension == 2
    assert observable(A, np.array([[1.0, 1.0, 0.0, 0.0]])).is_complete
    assert controllable(A, np.zeros((4, 1))).dimension == 0


@pytest.mark.parametrize("seed", range(20))
def test_ranks_of_hidden_parts(seed: int) -> None:
    """A random block-triangular system in random coordinates: the rank is that of the block."""
    rng = np.random.default_rng(seed)
    size, reached = 8, int(rng.integers(1, 8))
    A = rng.normal(size=(size, size))
    A[reached:, :reached] = 0
    B = np.zeros((size, 2))
    B[:reached] = rng.normal(size=(reached, 2))
    turn, _ = np.linalg.qr(rng.normal(size=(size, size)))
    found = controllable(turn @ A @ turn.T, turn @ B)
    assert found.dimension == reached
    expected = np.linalg.eigvals(A[reached:, reached:])
    for value in found.remaining:
        assert np.abs(expected - value).min() < 1e-10
