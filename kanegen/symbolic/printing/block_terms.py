"""Symbolic products and sums of the notes' 3 x 3 blocks, which are printed and never multiplied out."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum

from kanegen.symbolic import notation, notebook


class Formula(ABC):
    """A formula in the notation of the notes, which notebooks show."""

    @abstractmethod
    def text(self) -> str:
        """Return the formula in plain text."""

    def __repr__(self) -> str:
        """The formula in plain text."""
        return f"<{self.text()}>"

    def _repr_latex_(self) -> str:
        """The formula for a notebook, in several lines if it is long."""
        return notebook.display(f"&{notation.latex(line)}" for line in notation.lines(self.text()))


class Kind(Enum):
    """The kinds of factors by text, with {K} for the body and {J} for its lower body."""

    ROTATION = "[^{J}R_{K}]"
    ROTATION_FROM_GROUND = "[R_{K}]"
    ANGLE_RATE_MATRIX = "[P̂_{K}]"
    ANGLE_RATE_MATRIX_RATE = "[Ṗ̂_{K}]"
    RELATIVE_OMEGA = "{{ω̂'_{K}}}"
    RELATIVE_OMEGA_TILDE_T = "[^{J}ω̃'_{K}]^T"
    OMEGA_TILDE_T = "[ω̃'_{K}]^T"
    OMEGA_TILDE = "[ω̃'_{K}]"
    OFFSET_TILDE = "([q̃'_{K}]+[s̃'_{K}])"
    OFFSET_RATE_TILDE = "[ṡ̃'_{K}]"
    MASS_CENTER_TILDE = "[r̃'_{K}]"
    IDENTITY = "[I]"
    JOINT_ORIENTATION_T = "[C_{K}]^T"
    JOINT_POSITION = "{{q'_{K}}}"
    TRANSLATION = "{{s'_{K}}}"
    TRANSLATION_RATE = "{{ṡ'_{K}}}"
    MASS_CENTER = "{{r'_{K}}}"


@dataclass(frozen=True, repr=False)
class Factor(Formula):
    """One matrix or column of body K on its lower body J.

    Attributes:
        kind: Which matrix or column it is.
        body: Number K of the body.
        lower: Number J of its lower body, 0 for the ground.
    """

    kind: Kind
    body: int
    lower: int

    def text(self) -> str:
        """Return the factor in plain text, such as `[^1R_2]`."""
        return str(self.kind.value.format(K=self.body, J=self.lower))


@dataclass(frozen=True, repr=False)
class Product(Formula):
    """A product of matrices and columns that is not multiplied out.

    Attributes:
        factors: Factors from left to right; the last may be a sum or a row.
    """

    factors: tuple[Term, ...]

    def text(self) -> str:
        """Return the factors side by side in plain text, a sum in parentheses."""
        return "".join(f"({f.text()})" if isinstance(f, Sum) else f.text() for f in self.factors)


@dataclass(frozen=True, repr=False)
class Row(Formula):
    """A row of 3 x 3 blocks.

    Attributes:
        blocks: N blocks for {y_1} or 2N for {y}; None for a zero.
        bodies: Number N of bodies.
    """

    blocks: tuple[Term | None, ...]
    bodies: int

    def text(self) -> str:
        """Return the blocks in brackets in plain text; a half of zeros is one block."""
        parts: list[str] = []
        for half in (self.blocks[: self.bodies], self.blocks[self.bodies :]):
            if half and not any(half):
                parts.append(f"[0]_{{3x{3 * self.bodies}}}")
            else:
                parts += ["[0]" if block is None else block.text() for block in half]
        return f"[{', '.join(parts)}]"


@dataclass(frozen=True, repr=False)
class Sum(Formula):
    """A sum of terms with their signs.

    Attributes:
        terms: Signs, +1 or -1, and terms from left to right.
    """

    terms: tuple[tuple[int, Term], ...]

    def text(self) -> str:
        """Return the terms in one line of plain text."""
        return " ".join(self.lines())

    def lines(self) -> list[str]:
        """Return a line of plain text for each term with its sign, + omitted in the first."""
        printed = [f"{'+' if sign > 0 else '-'} {term.text()}" for sign, term in self.terms]
        return [printed[0].removeprefix("+ "), *printed[1:]] if printed else ["0"]


Term = Factor | Product | Row | Sum
"""A part of an equation in blocks."""


def product(*factors: Term) -> Term:
    """Return the product of factors; products and positive sums of one term among them are opened."""
    flat: list[Term] = []
    for factor in factors:
        single = factor.terms[0] if isinstance(factor, Sum) and len(factor.terms) == 1 else None
        opened = single[1] if single is not None and single[0] > 0 else factor
        flat += opened.factors if isinstance(opened, Product) else (opened,)
    return flat[0] if len(flat) == 1 else Product(tuple(flat))


def total(*terms: Term) -> Sum:
    """Return the sum of terms in order; sums among them are opened."""
    flat: list[tuple[int, Term]] = []
    for term in terms:
        flat += term.terms if isinstance(term, Sum) else [(1, term)]
    return Sum(tuple(flat))


def times(factors: tuple[Factor, ...], terms: Sum, sign: int = 1) -> Sum:
    """Return a sum with `factors` in front of every term, and with its signs multiplied by `sign`."""
    return Sum(tuple((sign * s, product(*factors, term)) for s, term in terms.terms))
