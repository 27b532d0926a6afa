"""Modes of a linear model: frequency, damping and shape, and what its eigenvalues say about stability."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.linear.eigenvalues import Eigenvalues


@dataclass(frozen=True)
class Mode:
    """One way in which small deviations move: an eigenvalue, or a pair of conjugate ones, with its shape.

    Attributes:
        eigenvalue: The eigenvalue, of a pair the one with positive imaginary part (1/s).
        error: Bound on the error of the eigenvalue by rounding (1/s).
        shape: Deviation of each coordinate in the mode by its name, complex where the coordinates are not in
            phase; the largest is 1 (rad, m).

    Example:
        mode = model.modes[0]
        mode.frequency, mode.damping_ratio, mode.shape["pole"]
    """

    eigenvalue: complex
    error: float
    shape: Mapping[str, complex]

    @property
    def oscillates(self) -> bool:
        """Whether the mode oscillates: the eigenvalue has an imaginary part."""
        return self.eigenvalue.imag > self.error

    @property
    def growth(self) -> float:
        """Growth rate, the real part of the eigenvalue (1/s); 0 where it is within its error."""
        return 0.0 if abs(self.eigenvalue.real) <= self.error else self.eigenvalue.real

    @property
    def frequency(self) -> float:
        """Frequency of the oscillation, the imaginary part over 2 pi (Hz)."""
        return self.eigenvalue.imag / (2 * math.pi)

    @property
    def natural_frequency(self) -> float:
        """Frequency without damping, the absolute value of the eigenvalue over 2 pi (Hz)."""
        return abs(self.eigenvalue) / (2 * math.pi)

    @property
    def damping_ratio(self) -> float:
        """Damping as a share of critical damping: -Re/|eigenvalue|; negative where the mode grows.

        It is NaN where the eigenvalue is 0.
        """
        size = abs(self.eigenvalue)
        return (0.0 - self.growth) / size if size > self.error else math.nan

    @property
    def kind(self) -> str:
        """The mode in words: "undamped oscillation", "decays", "grows", "neutral" and so on."""
        if self.oscillates:
            kinds = {0: "undamped oscillation", 1: "growing oscillation", -1: "damped oscillation"}
        else:
            kinds = {0: "neutral", 1: "grows", -1: "decays"}
        return kinds[int(np.sign(self.growth))]

    def moving(self, share: float = 0.01) -> tuple[str, ...]:
        """Return the names of the coordinates that take part, by size of their deviation.

        Args:
            share: Least deviation, as a share of the largest in the mode.

        Example:
            model.modes[0].moving()  # ("pole", "cart_position")
        """
        sizes = sorted(((-abs(value), name) for name, value in self.shape.items()), key=lambda pair: pair[0])
        return tuple(name for size, name in sizes if -size >= share)


@dataclass(frozen=True)
class Stability:
    """What the eigenvalues of a linear model say about the motion that it was made for.

    Attributes:
        verdict: "asymptotically stable" if all deviations decay; "unstable" if some deviation grows;
            "undecided" if none grows but some do not decay: the linear model does not decide then.
        reason: The eigenvalues behind the verdict, in words.
    """

    verdict: str
    reason: str

    def __str__(self) -> str:
        return f"{self.verdict}: {self.reason}"


def modes_of(found: Eigenvalues, names: Sequence[str], places: slice) -> tuple[Mode, ...]:
    """Return the modes of a linear model, those that grow first, then by frequency.

    Args:
        found: The eigenvalues of [A].
        names: Names of the coordinates.
        places: Places of the coordinates among the states.
    """
    modes = [
        Mode(complex(value), float(error), _shape(vector[places], names))
        for value, error, vector in zip(found.values, found.errors, found.vectors.T, strict=True)
        if value.imag >= 0 or -value.imag <= error
    ]
    ordered = sorted(modes, key=lambda mode: (-max(mode.growth, 0.0), abs(mode.eigenvalue), -mode.growth))
    return tuple(ordered)


def stability_of(modes: Sequence[Mode]) -> Stability:
    """Return what the eigenvalues say about stability."""
    growing = [mode for mode in modes if mode.growth > 0]
    if growing:
        fastest = max(growing, key=lambda mode: mode.growth)
        return Stability(
            "unstable",
            f"{_moves(fastest)} grows by a factor of e in {1 / fastest.growth:.4g} s",
        )
    lasting = [mode for mode in modes if mode.growth == 0]
    if not lasting:
        slowest = max(modes, key=lambda mode: mode.growth)
        return Stability(
            "asymptotically stable",
            f"every deviation decays, {_moves(slowest)} most slowly, by a factor of e in "
            f"{-1 / slowest.growth:.4g} s",
        )
    neutral = [mode for mode in lasting if not mode.oscillates]
    kinds = []
    if len(lasting) > len(neutral):
        count = len(lasting) - len(neutral)
        kinds.append(f"{count} {'mode oscillates' if count == 1 else 'modes oscillate'} without damping")
    if neutral:
        what = ", ".join(dict.fromkeys(_moves(mode) for mode in neutral))
        kinds.append(f"{what} neither returns nor grows exponentially")
    return Stability("undecided", "no deviation grows exponentially, but " + ", and ".join(kinds))


def _moves(mode: Mode) -> str:
    """Return the names of the coordinates that mainly take part in a mode."""
    return " with ".join(mode.moving(0.5)[:3])


def _shape(vector: np.ndarray, names: Sequence[str]) -> dict[str, complex]:
    """Return the deviations of coordinates, divided by the largest; a rounding error of 0 is 0."""
    largest = int(np.argmax(np.abs(vector)))
    if vector[largest] == 0:
        return dict.fromkeys(names, 0j)
    scaled = vector / vector[largest]
    scaled[largest] = 1
    tiny = 64 * np.finfo(np.float64).eps
    real, imaginary = (np.where(np.abs(part) <= tiny, 0.0, part) for part in (scaled.real, scaled.imag))
    return {name: complex(a, b) for name, a, b in zip(names, real, imaginary, strict=True)}
