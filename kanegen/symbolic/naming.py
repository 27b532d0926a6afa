"""Names for intermediate quantities of the literal derivation, so that big trees stay readable.

Each quantity of a body is a matrix. Where intermediates are wanted, every entry that is more than a number
or a symbol is replaced by a symbol of its own; the replaced expression becomes a `Definition`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from sympy import Expr, ImmutableMatrix

from kanegen.symbolic.definitions import Definition, is_atom
from kanegen.symbolic.symbols import real


@dataclass(frozen=True)
class Quantity:
    """How the entries of one quantity are named.

    Attributes:
        stem: Start of the name; `{K}` and `{J}` stand for the body and its lower body.
        note: What it is, with its equation.
        index: How an entry's row and column, from 1, end the name.
    """

    stem: str
    note: str
    index: Callable[[int, int], str]


def _component(row: int, column: int) -> str:
    return f"{row}"


def _entry(row: int, column: int) -> str:
    return f"{row}{column}"


def _partial(row: int, column: int) -> str:
    return f"{row}_y{column}"


QUANTITIES = {
    "sines": Quantity("S_{K}", "sines of the angles", _component),
    "cosines": Quantity("C_{K}", "cosines of the angles", _component),
    "joint_orientation": Quantity("joint_{K}", "constant orientation of the joint frame", _entry),
    "relative_rotation": Quantity("R_{J}_{K}", "rotation from the lower body, Eq. (4)", _entry),
    "rotation": Quantity("R_{K}", "rotation from the inertial frame, Eq. (5)", _entry),
    "angle_rate_matrix": Quantity("P_{K}", "angle-rate matrix, Eq. (17)", _entry),
    "angle_rate_matrix_rate": Quantity("Pdot_{K}", "its time derivative, Eq. (20)", _entry),
    "offset": Quantity("d_{K}", "from O_J to O_K in J, Eq. (22)", _component),
    "offset_rate": Quantity("ddot_{K}", "its time derivative in J, Eq. (24)", _component),
    "position_of_origin": Quantity("pO_{K}", "position of O_K, Eq. (22)", _component),
    "relative_angular_velocity": Quantity("omegahat_{K}", "relative angular velocity, Eq. (8)", _component),
    "angular_velocity": Quantity("omega_{K}", "angular velocity, Eq. (11)", _component),
    "partial_angular_velocity": Quantity("omega_{K}", "partial angular velocity, Eq. (15)", _partial),
    "partial_angular_velocity_rate": Quantity("omegadot_{K}", "its time derivative, Eq. (20)", _partial),
    "velocity_of_origin": Quantity("vO_{K}", "velocity of O_K in J, Eq. (25)", _component),
    "velocity_of_center": Quantity("vG_{K}", "velocity of G_K, Eq. (27)", _component),
    "partial_velocity_of_origin": Quantity("vO_{K}", "partial velocity of O_K, Eq. (28)", _partial),
    "partial_velocity_of_center": Quantity("vG_{K}", "partial velocity of G_K, Eq. (32)", _partial),
    "partial_velocity_of_origin_rate": Quantity("vOdot_{K}", "its time derivative, Eq. (35)", _partial),
    "partial_velocity_of_center_rate": Quantity("vGdot_{K}", "its time derivative, Eq. (34)", _partial),
    "partial_angular_momentum": Quantity("H_{K}", "partial angular momentum, Eq. (40)", _partial),
    "net_force": Quantity("Fnet_{K}", "force less mass times acceleration without {ydot}", _component),
    "net_torque": Quantity("Mnet_{K}", "torque less inertia torque without {ydot}", _component),
}
"""Every named quantity of a body, in an order in which each needs only earlier ones."""


@dataclass(frozen=True)
class Names:
    """Replaces the entries of one body's quantities by symbols, where that is wanted.

    Attributes:
        body: K.
        lower: J.
        wanted: Whether to name anything.
        taken: Names that must not be used, those of parameters.
    """

    body: int
    lower: int
    wanted: bool
    taken: frozenset[str]
    _definitions: dict[str, tuple[Definition, ...]] = field(default_factory=dict, init=False, repr=False)

    def apply(self, name: str, matrix: ImmutableMatrix) -> ImmutableMatrix:
        """`matrix`, the quantity `name` of `QUANTITIES`, with symbols for its longer entries."""
        if not self.wanted:
            return matrix
        quantity = QUANTITIES[name]
        made: list[Definition] = []

        def entry(value: Expr, row: int, column: int) -> Expr:
            if is_atom(value):
                return value
            symbol = self._symbol(f"{quantity.stem}_{quantity.index(row + 1, column + 1)}")
            made.append(Definition(symbol, value, f"Body {self.body}: {quantity.note}"))
            return symbol

        rows, columns = matrix.shape
        entries = [[entry(matrix[i, j], i, j) for j in range(columns)] for i in range(rows)]
        self._definitions[name] = tuple(made)
        return ImmutableMatrix(entries)

    def definitions(self, name: str) -> tuple[Definition, ...]:
        """The definitions that `apply` made for the quantity `name`."""
        return self._definitions.get(name, ())

    def _symbol(self, template: str) -> Expr:
        name = template.format(K=self.body, J=self.lower)
        while name in self.taken:
            name += "_"
        return real(name)
