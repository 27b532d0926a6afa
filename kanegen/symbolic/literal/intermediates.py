"""Symbols for intermediate quantities of the literal derivation, so that large trees stay readable.

Each quantity of a body is a matrix. Where intermediates are wanted, every entry that is more than a number or
a symbol is replaced by a new symbol, and the expression becomes a `Definition`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from sympy import Expr, ImmutableMatrix, Symbol

from kanegen.symbolic.definitions import Definition, is_atom
from kanegen.symbolic.matrices import FiniteMatrix
from kanegen.symbolic.symbols import real


class Index(Enum):
    """The index by which a name, and its LaTeX, distinguish an entry from others of its matrix."""

    COMPONENT = "{row}", "{row}"
    ENTRY = "{row}{column}", "{row}{column}"
    PARTIAL = "{row}_y{column}", "{row},y_{{{column}}}"

    def ending(self, row: int, column: int) -> str:
        """Return the end of a name; rows and columns count from 1."""
        return str(self.value[0]).format(row=row, column=column)

    def latex(self, row: int, column: int) -> str:
        """Return the index in LaTeX; rows and columns count from 1."""
        return str(self.value[1]).format(row=row, column=column)


@dataclass(frozen=True)
class Quantity:
    """The naming scheme of the entries of one quantity.

    Attributes:
        stem: Start of the name; `{K}` and `{J}` stand for the body and its lower body.
        latex: Template of the LaTeX, where `{I}` stands for the index of the entry.
        note: Description of the quantity, with its equation.
        index: Form of the index of an entry.
    """

    stem: str
    latex: str
    note: str
    index: Index


QUANTITIES = {
    "sines": Quantity("S_{K}", r"S_{{{K},{I}}}", "sines of the angles", Index.COMPONENT),
    "cosines": Quantity("C_{K}", r"C_{{{K},{I}}}", "cosines of the angles", Index.COMPONENT),
    "rotation_factor": Quantity(
        "h_{K}", r"h_{{{K}}}", "2 over the squared length of the quaternion", Index.COMPONENT
    ),
    "joint_orientation": Quantity(
        "joint_{K}", r"[C_{{{K}}}]_{{{I}}}", "constant orientation of the joint frame", Index.ENTRY
    ),
    "relative_rotation": Quantity(
        "R_{J}_{K}", r"[{{}}^{{{J}}}R_{{{K}}}]_{{{I}}}", "rotation from the lower body, Eq. (4)", Index.ENTRY
    ),
    "rotation": Quantity(
        "R_{K}", r"[R_{{{K}}}]_{{{I}}}", "rotation from the inertial frame, Eq. (5)", Index.ENTRY
    ),
    "angle_rate_matrix": Quantity(
        "P_{K}", r"[\hat{{P}}_{{{K}}}]_{{{I}}}", "angle-rate matrix, Eq. (17)", Index.ENTRY
    ),
    "angle_rate_matrix_rate": Quantity(
        "Pdot_{K}", r"[\dot{{\hat{{P}}}}_{{{K}}}]_{{{I}}}", "its time derivative, Eq. (20)", Index.ENTRY
    ),
    "offset": Quantity("d_{K}", r"d_{{{K},{I}}}", "from O_J to O_K in J, Eq. (22)", Index.COMPONENT),
    "offset_rate": Quantity(
        "ddot_{K}", r"\dot{{d}}_{{{K},{I}}}", "its time derivative in J, Eq. (24)", Index.COMPONENT
    ),
    "relative_angular_velocity": Quantity(
        "omegahat_{K}",
        r"{{\hat{{\omega}}'}}_{{{K},{I}}}",
        "relative angular velocity, Eq. (8)",
        Index.COMPONENT,
    ),
    "angular_velocity": Quantity(
        "omega_{K}", r"{{\omega'}}_{{{K},{I}}}", "angular velocity, Eq. (11)", Index.COMPONENT
    ),
    "partial_angular_velocity": Quantity(
        "omega_{K}", r"{{\omega'}}_{{{K},{I}}}", "partial angular velocity, Eq. (15)", Index.PARTIAL
    ),
    "partial_angular_velocity_rate": Quantity(
        "omegadot_{K}", r"{{\dot{{\omega}}'}}_{{{K},{I}}}", "its time derivative, Eq. (20)", Index.PARTIAL
    ),
    "velocity_of_origin": Quantity(
        "vO_{K}", r"{{v'}}_{{O_{{{K}}},{I}}}", "velocity of O_K in J, Eq. (25)", Index.COMPONENT
    ),
    "velocity_of_center": Quantity(
        "vG_{K}", r"{{v'}}_{{G_{{{K}}},{I}}}", "velocity of G_K, Eq. (27)", Index.COMPONENT
    ),
    "partial_velocity_of_origin": Quantity(
        "vO_{K}", r"{{v'}}_{{O_{{{K}}},{I}}}", "partial velocity of O_K in J, Eq. (28)", Index.PARTIAL
    ),
    "partial_velocity_of_center": Quantity(
        "vG_{K}", r"{{v'}}_{{G_{{{K}}},{I}}}", "partial velocity of G_K, Eq. (32)", Index.PARTIAL
    ),
    "partial_velocity_of_origin_rate": Quantity(
        "vOdot_{K}", r"{{\dot{{v}}'}}_{{O_{{{K}}},{I}}}", "its time derivative, Eq. (35)", Index.PARTIAL
    ),
    "partial_velocity_of_center_rate": Quantity(
        "vGdot_{K}", r"{{\dot{{v}}'}}_{{G_{{{K}}},{I}}}", "its time derivative, Eq. (34)", Index.PARTIAL
    ),
    "remaining_angular_velocity": Quantity(
        "omegat_{K}",
        r"{{\omega'}}_{{t,{K},{I}}}",
        "angular velocity of what is prescribed",
        Index.COMPONENT,
    ),
    "remaining_angular_velocity_rate": Quantity(
        "omegatdot_{K}", r"{{\dot{{\omega}}'}}_{{t,{K},{I}}}", "its time derivative", Index.COMPONENT
    ),
    "remaining_velocity_of_origin": Quantity(
        "vOt_{K}",
        r"{{v'}}_{{t,O_{{{K}}},{I}}}",
        "velocity of O_K in J of what is prescribed",
        Index.COMPONENT,
    ),
    "remaining_velocity_of_origin_rate": Quantity(
        "vOtdot_{K}", r"{{\dot{{v}}'}}_{{t,O_{{{K}}},{I}}}", "its time derivative", Index.COMPONENT
    ),
    "remaining_velocity_of_center_rate": Quantity(
        "vGtdot_{K}",
        r"{{\dot{{v}}'}}_{{t,G_{{{K}}},{I}}}",
        "time derivative of the velocity of G_K of what is prescribed",
        Index.COMPONENT,
    ),
    "partial_angular_momentum": Quantity(
        "H_{K}", r"{{H'}}_{{{K},{I}}}", "inertia times partial angular velocity, Eq. (40)", Index.PARTIAL
    ),
    "net_force": Quantity(
        "Fnet_{K}",
        r"{{F'}}_{{\mathrm{{net}},{K},{I}}}",
        "force less mass times the acceleration without {ydot}, Eq. (39)",
        Index.COMPONENT,
    ),
    "net_torque": Quantity(
        "Mnet_{K}",
        r"{{M'}}_{{\mathrm{{net}},{K},{I}}}",
        "torque less the inertia torque without {ydot}, Eqs. (40), (41)",
        Index.COMPONENT,
    ),
}
"""All named quantities of a body by the name of their property, each after those that it depends on."""


@dataclass(frozen=True)
class Intermediates:
    """Replaces entries of the quantities of one body by symbols and keeps the definitions.

    Attributes:
        body: Number K of the body.
        lower: Number J of its lower body, 0 for the ground.
        wanted: Whether entries are replaced; if not, nothing is defined.
        taken: Names that must not be used, those of parameters.
        latex: LaTeX of the symbols made so far.
    """

    body: int
    lower: int
    wanted: bool
    taken: frozenset[str]
    latex: dict[Symbol, str] = field(default_factory=dict, init=False, repr=False)
    _definitions: dict[str, tuple[Definition, ...]] = field(default_factory=dict, init=False, repr=False)

    def named(self, name: str, matrix: ImmutableMatrix) -> ImmutableMatrix:
        """Return a matrix with symbols for its longer entries.

        Args:
            name: Name of the quantity in `QUANTITIES`.
            matrix: Value of the quantity.
        """
        if not self.wanted:
            return matrix
        quantity = QUANTITIES[name]
        made: list[Definition] = []

        def entry(value: Expr, row: int, column: int) -> Expr:
            if is_atom(value):
                return value
            symbol = self._symbol(quantity, row, column)
            made.append(Definition(symbol, value, f"Body {self.body}: {quantity.note}"))
            return symbol

        rows, columns = matrix.shape
        entries = [[entry(matrix[i, j], i + 1, j + 1) for j in range(columns)] for i in range(rows)]
        self._definitions[name] = tuple(made)
        return FiniteMatrix(entries)

    def definitions(self, name: str) -> tuple[Definition, ...]:
        """Return the definitions of the entries of the quantity `name`."""
        return self._definitions.get(name, ())

    def _symbol(self, quantity: Quantity, row: int, column: int) -> Symbol:
        """Return the symbol of an entry, and record its LaTeX; rows and columns count from 1."""
        stem = quantity.stem.format(K=self.body, J=self.lower)
        name = f"{stem}_{quantity.index.ending(row, column)}"
        while name in self.taken:
            name += "_"
        symbol = real(name)
        index = quantity.index.latex(row, column)
        self.latex[symbol] = quantity.latex.format(K=self.body, J=self.lower, I=index)
        return symbol
