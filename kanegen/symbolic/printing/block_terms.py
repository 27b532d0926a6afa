"""Symbolic products and sums of the notes' 3 x 3 blocks, which are printed and never multiplied out."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Kind(Enum):
    """The kinds of factors by text and LaTeX, with {K} for the body and {J} for its lower body."""

    ROTATION = "[^{J}R_{K}]", r"[{{}}^{{{J}}}R_{{{K}}}]"
    ROTATION_FROM_GROUND = "[R_{K}]", r"[R_{{{K}}}]"
    ANGLE_RATE_MATRIX = "[P̂_{K}]", r"[\hat{{P}}_{{{K}}}]"
    ANGLE_RATE_MATRIX_RATE = "[Ṗ̂_{K}]", r"[\dot{{\hat{{P}}}}_{{{K}}}]"
    RELATIVE_OMEGA_TILDE_T = "[^{J}ω̃'_{K}]^T", r"[{{}}^{{{J}}}\tilde{{\omega}}'_{{{K}}}]^T"
    OMEGA_TILDE_T = "[ω̃'_{K}]^T", r"[\tilde{{\omega}}'_{{{K}}}]^T"
    OMEGA_TILDE = "[ω̃'_{K}]", r"[\tilde{{\omega}}'_{{{K}}}]"
    OFFSET_TILDE = "([q̃'_{K}]+[s̃'_{K}])", r"([\tilde{{q}}'_{{{K}}}]+[\tilde{{s}}'_{{{K}}}])"
    OFFSET_RATE_TILDE = "[ṡ̃'_{K}]", r"[\dot{{\tilde{{s}}}}'_{{{K}}}]"
    MASS_CENTER_TILDE = "[r̃'_{K}]", r"[\tilde{{r}}'_{{{K}}}]"
    IDENTITY = "[I]", "[I]"
    JOINT_ORIENTATION_T = "[C_{K}]^T", r"[C_{{{K}}}]^T"
    JOINT_POSITION = "{{q'_{K}}}", r"\lbrace q'_{{{K}}}\rbrace "
    TRANSLATION = "{{s'_{K}}}", r"\lbrace s'_{{{K}}}\rbrace "
    TRANSLATION_RATE = "{{ṡ'_{K}}}", r"\lbrace \dot{{s}}'_{{{K}}}\rbrace "
    MASS_CENTER = "{{r'_{K}}}", r"\lbrace r'_{{{K}}}\rbrace "

    @property
    def text(self) -> str:
        """The template in plain text."""
        return str(self.value[0])

    @property
    def latex(self) -> str:
        """The template in LaTeX."""
        return str(self.value[1])


@dataclass(frozen=True)
class Factor:
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
        return self.kind.text.format(K=self.body, J=self.lower)

    def latex(self) -> str:
        """Return the factor in LaTeX, such as `[{}^{1}R_{2}]`."""
        return self.kind.latex.format(K=self.body, J=self.lower)


@dataclass(frozen=True)
class Product:
    """A product of matrices and columns that is not multiplied out.

    Attributes:
        factors: Factors from left to right; the last may be a sum or a row.
    """

    factors: tuple[Term, ...]

    def text(self) -> str:
        """Return the factors side by side in plain text, a sum in parentheses."""
        return "".join(f"({f.text()})" if isinstance(f, Sum) else f.text() for f in self.factors)

    def latex(self) -> str:
        """Return the factors side by side in LaTeX, a sum in parentheses."""
        return "".join(
            rf"\left({f.latex()}\right)" if isinstance(f, Sum) else f.latex() for f in self.factors
        )


@dataclass(frozen=True)
class Row:
    """A row of 3 x 3 blocks.

    Attributes:
        blocks: N blocks for {y_1} or 2N for {y}; None for a zero.
        bodies: Number N of bodies.
    """

    blocks: tuple[Term | None, ...]
    bodies: int

    def text(self) -> str:
        """Return the blocks in brackets in plain text; a half of zeros is one block."""
        return f"[{', '.join(self._parts('text'))}]"

    def latex(self) -> str:
        """Return the blocks in brackets in LaTeX; a half of zeros is one block."""
        return rf"\left[{', '.join(self._parts('latex'))}\right]"

    def _parts(self, form: str) -> list[str]:
        """Return the printed blocks; `form` is "text" or "latex"."""
        halves = (self.blocks[: self.bodies], self.blocks[self.bodies :])
        parts: list[str] = []
        for half in halves:
            if half and not any(half):
                width = 3 * self.bodies
                parts.append(f"[0]_{{3x{width}}}" if form == "text" else rf"[0]_{{3\times {width}}}")
            else:
                parts += ["[0]" if block is None else getattr(block, form)() for block in half]
        return parts


@dataclass(frozen=True)
class Sum:
    """A sum of terms with their signs.

    Attributes:
        terms: Signs, +1 or -1, and terms from left to right.
    """

    terms: tuple[tuple[int, Term], ...]

    def text(self) -> str:
        """Return the terms in one line of plain text."""
        return self._joined([term.text() for _, term in self.terms])

    def latex(self) -> str:
        """Return the terms in one line of LaTeX."""
        return self._joined([term.latex() for _, term in self.terms])

    def lines(self, form: str = "text") -> list[str]:
        """Return a line for each term with its sign, + omitted in the first; `form` is "text" or "latex"."""
        printed = [f"{'+' if sign > 0 else '-'} {getattr(term, form)()}" for sign, term in self.terms]
        return [printed[0].removeprefix("+ "), *printed[1:]] if printed else ["0"]

    def _joined(self, terms: list[str]) -> str:
        """Return printed terms with their signs in one line."""
        if not terms:
            return "0"
        signs = ["" if sign > 0 else "-" for sign, _ in self.terms[:1]]
        signs += [" + " if sign > 0 else " - " for sign, _ in self.terms[1:]]
        return "".join(sign + term for sign, term in zip(signs, terms, strict=True))


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
