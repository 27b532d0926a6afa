"""The eleven systems, each with its model file, its KanesMethod and its textbook form."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import sympy
from sympy import Dummy, Expr, Matrix, Rational

import kanegen as kg
from benchmarks.closed_forms import kane, textbook
from kanegen.symbolic.closed.form import ClosedForm

MODELS = Path(__file__).parents[2] / "models"


@dataclass(frozen=True)
class Entries:
    """[A] and {f} in kanegen's symbols.

    Attributes:
        A: (n, n) [A].
        f: (n, 1) {f}.
    """

    A: Matrix
    f: Matrix

    @property
    def operations(self) -> tuple[int, int]:
        """Operations in [A], of each entry on and above the diagonal, and in {f}; see `operations`."""
        n = self.A.rows
        return operations(self.A[i, j] for i in range(n) for j in range(i, n)), operations(self.f)


@dataclass(frozen=True)
class Case:
    """One system.

    Attributes:
        name: Name of the model file.
        title: What it is, in words.
        folder: Folder of the model file in models/.
    """

    name: str
    title: str
    folder: str = "textbook"

    @property
    def system(self) -> kg.System:
        """The system of the model file."""
        return kg.load(MODELS / self.folder / f"{self.name}.toml")

    def closed_form(self) -> ClosedForm:
        """Return the closed form of kanegen."""
        return kg.derive(self.system).closed_form()

    def by_kanes_method(self, simplify: bool = True) -> Entries:
        """Return the equations of KanesMethod, simplified by SymPy if that is asked for."""
        derive: Callable[[], tuple[kane.Scene, Matrix, Matrix]] = getattr(kane, self.name)
        scene, A, f = derive()
        if simplify:
            A, f = sympy.simplify(A), sympy.simplify(f)
        symbols = scene.symbols()
        return Entries(A.subs(symbols), f.subs(symbols))

    def of_textbook(self) -> Entries:
        """Return the equations of a textbook."""
        form: Callable[[], textbook.Form] = getattr(textbook, self.name)
        A, f = form()
        return Entries(Matrix(A), Matrix(f))


CASES = (
    Case("babyboot", "babyboot"),
    Case("spherical_pendulum", "spherical pendulum"),
    Case("furuta_pendulum", "Furuta pendulum", folder=""),
    Case("gantry_crane", "gantry crane", folder=""),
    Case("quarter_car", "quarter car", folder=""),
    Case("double_pendulum", "double pendulum", folder=""),
    Case("triple_pendulum", "triple pendulum"),
    Case("euler_top", "top, angles 3-1-3"),
    Case("gyrostat", "gyrostat"),
    Case("bead_on_hoop", "bead on a hoop"),
    Case("cart_two_poles", "cart with two poles", folder=""),
)


def operations(entries: Iterable[Expr]) -> int:
    """Return the number of operations in expressions as SymPy's `count_ops` counts them.

    Every addition, subtraction, product, quotient, power, change of sign and call of a function is one. A
    number costs nothing, also where SymPy holds it as a fraction: 981/100 counts as 9.81.
    """
    return sum(int(_with_plain_numbers(entry).count_ops()) for entry in entries)


def _with_plain_numbers(entry: Expr) -> Expr:
    """Return an expression with symbols in place of fractions, which SymPy counts as divisions."""
    fractions = [number for number in entry.atoms(Rational) if not number.is_Integer]
    symbols = {number: Dummy(positive=True) for number in map(abs, fractions)}
    return entry.xreplace({number: sympy.sign(number) * symbols[abs(number)] for number in fractions})
