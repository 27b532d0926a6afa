"""The equations of a body as the notes display them: by the lower body, and written out in blocks.

Every row has the number of its equation in the notes. Rows that the notes display without a number stand with
those beside them. `Blocks` gives the rows that are written out, the equations of the body its matrices of
sines and cosines.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from sympy import ImmutableMatrix

from kanegen.symbolic import notation
from kanegen.symbolic.equations import Equations
from kanegen.symbolic.literal.dynamics import BodyEquations
from kanegen.symbolic.printers import LINE, matrix_width
from kanegen.symbolic.printing.block_terms import Kind, Row, Sum
from kanegen.symbolic.printing.blocks import GROUND, Blocks
from kanegen.symbolic.printing.statements import BlockStatement, Equation, MatrixStatement, SymbolLatex

BlockRow = BlockStatement | MatrixStatement | Equation
"""A row of blocks, a matrix of 3 x 3 entries, or one of its entries."""


@dataclass(frozen=True)
class BodyRows:
    """The rows of body K.

    Attributes:
        equations: The equations of the system, with intermediates.
        number: Number K of the body, from 1.
        names: LaTeX of symbols.
    """

    equations: Equations
    number: int
    names: SymbolLatex = field(repr=False)

    def rows(self) -> Iterator[BlockRow]:
        """Yield the rows in the order of the notes."""
        yield from self._orientation()
        if self._turning:
            yield from self._angular_motion()
        yield from self._linear_motion()
        yield from self._dynamics()

    @property
    def _blocks(self) -> Blocks:
        return Blocks(self.equations.system)

    @property
    def _body(self) -> BodyEquations:
        return self.equations.bodies[self.number - 1]

    @property
    def _lower(self) -> int:
        return self._blocks.lower(self.number)

    @property
    def _turning(self) -> bool:
        """Whether the body ever turns in the inertial frame."""
        return self._turns(self.number)

    def _turns(self, k: int) -> bool:
        """Return whether a body, or the ground, ever turns in the inertial frame."""
        return any(map(self._blocks.turns, self._blocks.path(k)))

    def _moves(self, k: int) -> bool:
        """Return whether the origin of a body, or of the ground, ever moves."""
        path = [*self._blocks.path(k)]
        return any(self._blocks.slides(each) for each in path) or any(map(self._turns, path[1:]))

    @property
    def _rotation(self) -> str:
        """[^J R_K], or [R_K] on the ground."""
        return f"[{self._before}R_{self.number}]"

    @property
    def _before(self) -> str:
        """The index of the lower body before a letter; none on the ground."""
        return f"^{self._lower}" if self._lower != GROUND else ""

    @property
    def _carried(self) -> str:
        """[^L(J) R_J], or [R_J] where J is on the ground."""
        lower = self._blocks.lower(self._lower)
        return f"[{f'^{lower}' if lower != GROUND else ''}R_{self._lower}]"

    @property
    def _has_remainder(self) -> bool:
        """Whether something is prescribed, so that velocities have parts without {y}."""
        return bool(self.equations.system.prescribed)

    def _orientation(self) -> Iterator[BlockRow]:
        """Yield the rows on orientation, Eqs. (2)-(9)."""
        k, j, body = self.number, self._lower, self._body
        yield from self._matrix("(2), (4)" if j else "(4)", self._rotation, "relative_rotation")
        if j != GROUND:
            factors = [self._factor_of_rotation(each) for each in self._blocks.path(k)]
            forms = [f"{self._rotation}[R_{j}]", "".join(factors)]
            yield BlockStatement("(3), (5)", f"[R_{k}]", _lines(forms))
        if self._turning:
            yield BlockStatement("(6)", f"[Ṙ_{k}]", ((f"[ω̃'_{k}]^T[R_{k}]",),))
        if not self._blocks.turns(k):
            return
        if j != GROUND:
            relative = f"[{self._before}ω̃'_{k}]^T{self._rotation}"
            yield BlockStatement("(7)", f"[{self._before}Ṙ_{k}]", ((relative,),))
        rates = f"{{{'θ̂̇' if body.sines else 'ε̇'}_{k}}}"
        if body.body.joint.speeds_are_rates:
            yield from self._matrix("(17)", f"[P̂_{k}]", "angle_rate_matrix")
            yield BlockStatement("(8)", f"{{ω̂'_{k}}}", ((f"[P̂_{k}]{rates}",),))
        if body.body.joint.has_free_orientation:
            inverse = body.angle_rate_inverse
            yield MatrixStatement("(9)", rates, inverse, self.names, f"{{ω̂'_{k}}}")

    def _factor_of_rotation(self, k: int) -> str:
        """Return [^J R_K] of a body on the path, [R_K] on the ground."""
        lower = self._blocks.lower(k)
        return f"[{f'^{lower}' if lower != GROUND else ''}R_{k}]"

    def _matrix(self, number: str, name: str, quantity: str) -> Iterator[BlockRow]:
        """Yield the statement of a matrix of the body, or of its entries if it is too wide for a page."""
        named = getattr(self._body, quantity)
        definitions = {each.symbol: each.value for each in self._body.intermediates.definitions(quantity)}
        value = ImmutableMatrix(named.xreplace(definitions))
        if matrix_width(value, self.names) <= LINE:
            yield MatrixStatement(number, name, value, self.names)
            return
        for i, row in enumerate(value.tolist(), start=1):
            for j, entry in enumerate(row, start=1):
                left = f"{notation.latex(name)}_{{{i}{j}}}"
                yield Equation(f"{name}_{i}{j}", left, entry, self.names, number)

    def _angular_motion(self) -> Iterator[BlockRow]:
        """Yield the rows on angular motion, Eqs. (11)-(20)."""
        k, j, blocks = self.number, self._lower, self._blocks
        turns, carried = blocks.turns(k), self._turns(j)
        by_lower = _sum([f"{self._rotation}{{ω'_{j}}}"] * carried + [f"{{ω̂'_{k}}}"] * turns)
        yield BlockStatement("(11)", f"{{ω'_{k}}}", _lines([by_lower, blocks.angular_velocity(k)]))
        own = [f"[ω̂'_{k},y1]"] * blocks.turns_freely(k)
        by_lower = _sum([f"{self._rotation}[ω'_{j},y1]"] * carried + own)
        if own:
            relative = blocks.relative_partial_angular_velocity(k)
            yield BlockStatement("(16)", own[0], _lines([relative]))
        row = blocks.partial_angular_velocity(k)
        yield BlockStatement("(12)-(15)", f"[ω'_{k},y1]", _lines([by_lower, row]))
        remainder = [f"{{ω'_t,{k}}}"] * self._has_remainder
        whole = _sum([f"[ω'_{k},y1]{{y_1}}", *remainder])
        yield BlockStatement("(18), (19)", f"{{ω'_{k}}}", _lines([whole]))
        if own and not blocks.has_angular_velocity_speeds(k):
            yield from self._matrix("below (20)", f"[Ṗ̂_{k}]", "angle_rate_matrix_rate")
            rate = blocks.relative_partial_angular_velocity(k, Kind.ANGLE_RATE_MATRIX_RATE)
            own = [f"[ω̂̇'_{k},y1]"]
            yield BlockStatement("below (20)", own[0], _lines([rate]))
        else:
            own = []
        turned = [f"[{self._before}ω̃'_{k}]^T{self._rotation}[ω'_{j},y1]"] * (turns and carried)
        by_lower = _sum([f"{self._rotation}[ω̇'_{j},y1]"] * carried + turned + own)
        rate = blocks.partial_angular_velocity_rate(k)
        yield BlockStatement("(20)", f"[ω̇'_{k},y1]", _lines([by_lower, rate]))
        remainder = [f"{{ω̇'_t,{k}}}"] * self._has_remainder
        whole = _sum([f"[ω'_{k},y1]{{ẏ_1}}", f"[ω̇'_{k},y1]{{y_1}}", *remainder])
        yield BlockStatement("above (20)", f"{{α'_{k}}}", _lines([f"{{ω̇'_{k}}}", whole]))  # noqa: RUF001

    def _linear_motion(self) -> Iterator[BlockRow]:
        """Yield the rows on motion of points, Eqs. (22)-(35)."""
        k, j, blocks = self.number, self._lower, self._blocks
        offset = blocks.offset(k).text()
        below = [f"{{p'_O{j}}}"] * (j != GROUND)
        by_lower = f"{self._rotation}({_sum([*below, offset])})" if below or "+" in offset else ""
        position = blocks.position_of_origin(k)
        yield BlockStatement("(21), (22)", f"{{p'_O{k}}}", _lines([by_lower, position]))
        by_origin = f"{{p'_O{k}}} + {{r'_{k}}}"
        yield BlockStatement("(23)", f"{{p'_G{k}}}", _lines([by_origin, blocks.position_of_center(k)]))
        if not self._moves(k) and not self._turning:
            return
        carried, turns = self._moves(j), self._turns(j)
        slide = [blocks.translation_rate(k).text()] * blocks.slides(k)
        swing = [f"[ω̃'_{j}]({offset})"] * turns
        by_lower = _sum([f"{self._carried}{{v'_O{j}}}"] * carried + slide + swing)
        yield BlockStatement("(24), (25)", f"{{v'_O{k}}}", _lines([by_lower, blocks.velocity_of_origin(k)]))
        moves = [f"{self._rotation}{{v'_O{k}}}"] * self._moves(k)
        by_origin = _sum(moves + [f"[ω̃'_{k}]{{r'_{k}}}"] * self._turning)
        velocity = blocks.velocity_of_center(k)
        yield BlockStatement("(26), (27)", f"{{v'_G{k}}}", _lines([by_origin, velocity]))
        yield from self._partial_velocities()
        remainder = [f"{{v̇'_t,G{k}}}"] * self._has_remainder
        own = [f"[v'_G{k},y]{{ẏ}}", f"[v̇'_G{k},y]{{y}}", *remainder]
        turning = [f"[ω̃'_{k}]{{v'_G{k}}}"] * self._turning
        forms = [_sum([f"{{v̇'_G{k}}}", *turning]), _sum(own + turning)]
        yield BlockStatement("(33)", f"{{a'_G{k}}}", _lines(forms))

    def _partial_velocities(self) -> Iterator[BlockRow]:
        """Yield Eqs. (28)-(35), the partial velocities and their time derivatives."""
        k, j, blocks = self.number, self._lower, self._blocks
        carried, turns, arm = self._moves(j), self._turns(j), f"([q̃'_{k}]+[s̃'_{k}])"
        own = [f"[^{j or 'R'}v'_O{k},y]"] * blocks.slides_freely(k)
        if own:
            yield BlockStatement("(29), (30)", own[0], _lines([blocks.relative_partial_velocity(k)]))
        below = [f"{self._carried}[v'_O{j},y]"] * carried + [f"- {arm}[ω'_{j},y]"] * turns
        row = blocks.partial_velocity_of_origin(k)
        yield BlockStatement("(28)", f"[v'_O{k},y]", _lines([_sum(below + own), row]))
        moves = [f"{self._rotation}[v'_O{k},y]"] * self._moves(k)
        by_origin = _sum(moves + [f"- [r̃'_{k}][ω'_{k},y]"] * self._turning)
        row = blocks.partial_velocity_of_center(k)
        yield BlockStatement("(31), (32)", f"[v'_G{k},y]", _lines([by_origin, row]))
        below = [f"{self._carried}[v̇'_O{j},y]"] * carried
        below += [f"{self._carried_rate()}[v'_O{j},y]"] * (carried and blocks.turns(j))
        below += [f"- [ṡ̃'_{k}][ω'_{j},y]"] * (turns and blocks.slides(k))
        below += [f"- {arm}[ω̇'_{j},y]"] * turns
        row = blocks.partial_velocity_of_origin_rate(k)
        yield BlockStatement("(35)", f"[v̇'_O{k},y]", _lines([_sum(below), row]))
        own = [f"{self._rotation}[v̇'_O{k},y]"] * self._moves(k)
        own += [f"[{self._before}ω̃'_{k}]^T{self._rotation}[v'_O{k},y]"] * (blocks.turns(k) and self._moves(k))
        own += [f"- [r̃'_{k}][ω̇'_{k},y]"] * self._turning
        row = blocks.partial_velocity_of_center_rate(k)
        yield BlockStatement("(34)", f"[v̇'_G{k},y]", _lines([_sum(own), row]))

    def _carried_rate(self) -> str:
        """Return the time derivative of the rotation from the lower body of J to J, by Eq. (7)."""
        lower = self._blocks.lower(self._lower)
        return f"[{f'^{lower}' if lower != GROUND else ''}ω̃'_{self._lower}]^T{self._carried}"

    def _dynamics(self) -> Iterator[BlockRow]:
        """Yield what the body adds to {F_y}, [A] and {f}, Eqs. (36)-(44)."""
        k, system = self.number, self.equations.system
        has_mass, falls = self._body.body.mass != 0, any(value != 0 for value in system.gravity)
        moves = self._moves(k) or self._turning
        forces = [f"{{F'_{k}}}"] * self._body.body.loads + [f"m_{k}[R_{k}]{{g}}"] * (has_mass and falls)
        turning = self._turning
        acting = [f"[v'_G{k},y]^T{_bracketed(forces)}"] * (bool(forces) and moves)
        acting += [f"[ω'_{k},y]^T{{M'_{k}}}"] * (self._body.body.loads and turning)
        yield BlockStatement("(36), (37)", f"{{F_y,{k}}}", _lines([_sum(acting)]))
        inertial = [f"m_{k}[v'_G{k},y]^T[v'_G{k},y]"] * (has_mass and moves)
        inertial += [f"[ω'_{k},y]^T[I'_G{k}][ω'_{k},y]"] * turning
        yield BlockStatement("(43)", f"[A_{k}]", _lines([_sum(inertial)]))
        remainders = [f"{{v̇'_t,G{k}}}"] * self._has_remainder, [f"{{ω̇'_t,{k}}}"] * self._has_remainder
        linear = [f"[v̇'_G{k},y]{{y}}", *remainders[0], *[f"[ω̃'_{k}]{{v'_G{k}}}"] * turning]
        angular = [f"[ω̇'_{k},y]{{y}}", *remainders[1]]
        rest = [f"{{F_y,{k}}}"] * bool(acting)
        rest += [f"- m_{k}[v'_G{k},y]^T{_bracketed(linear)}"] * (has_mass and moves)
        if turning:
            rest.append(f"- [ω'_{k},y]^T[I'_G{k}]{_bracketed(angular)}")
            rest.append(f"- [ω'_{k},y]^T[ω̃'_{k}][I'_G{k}]{{ω'_{k}}}")
        yield BlockStatement("(39)-(41), (44)", f"{{f_{k}}}", _lines([_sum(rest)], one_a_line=True))


def system_rows(equations: Equations) -> Iterator[BlockRow]:
    """Yield the equations of motion of the whole system, Eqs. (37)-(45)."""
    system = equations.system
    elements = ["{F_y,e}"] * bool(system.force_elements or any(point.loads for _, point in system.points))
    motors = bool(system.motor_summaries)
    mass, turning = "m_K[v'_GK,y]^T", "[ω'_K,y]^T"
    inertia = f"{mass}[v'_GK,y] + {turning}[I'_GK][ω'_K,y]"
    rest = (
        "Σ_K {F_y,K}",
        f"- Σ_K {mass}[v̇'_GK,y]{{y}}",
        f"- Σ_K {mass}[ω̃'_K]{{v'_GK}}",
        f"- Σ_K {turning}[I'_GK][ω̇'_K,y]{{y}}",
        f"- Σ_K {turning}[ω̃'_K][I'_GK]{{ω'_K}}",
    )
    yield BlockStatement("(18)", "[ω'_K,y]", ((f"[[ω'_K,y1], [0]_{{3x{3 * len(system.bodies)}}}]",),))
    forces = _sum(["Σ_K {F_y,K}", *elements])
    by_bodies = "Σ_K ([v'_GK,y]^T({F'_K} + m_K[R_K]{g}) + [ω'_K,y]^T{M'_K})"
    yield BlockStatement("(37)", "{F_y}", ((forces,), (_sum([by_bodies, *elements]),)))
    yield BlockStatement("(38), (42)", "[A]{ẏ}", (("{f}",),))
    added = ["[A_m]"] * motors
    yield BlockStatement(
        "(43)", "[A]", ((_sum(["Σ_K [A_K]", *added]),), (_sum([f"Σ_K ({inertia})", *added]),))
    )
    added = [*elements, *["{f_m}"] * motors]
    whole = (*rest, *(f"+ {each}" for each in added))
    yield BlockStatement("(39)-(41), (44)", "{f}", ((_sum(["Σ_K {f_K}", *added]),), whole))
    if system.speeds_are_rates:
        yield BlockStatement("(1), (45)", "{ẋ}", (("{y}",),))


def _sum(terms: list[str]) -> str:
    """Return the sum of printed terms, of which some begin with "- "; "0" for none."""
    joined = " ".join(term if term.startswith("- ") else f"+ {term}" for term in terms if term)
    return joined.removeprefix("+ ") or "0"


def _bracketed(terms: list[str]) -> str:
    """Return the sum of terms, in parentheses if there are several."""
    return f"({_sum(terms)})" if len(terms) > 1 else _sum(terms)


def _lines(forms: Sequence[str | Row | Sum], one_a_line: bool = False) -> tuple[tuple[str, ...], ...]:
    """Return the lines of different forms of a right side, each form once; terms with rows a line each."""
    found: list[tuple[str, ...]] = []
    for form in forms:
        if isinstance(form, Sum):
            whole = form.lines()
            found.append(tuple(whole) if any("], [" in line for line in whole) else (" ".join(whole),))
        elif isinstance(form, Row):
            found.append((form.text(),))
        elif form:
            found.append((form,))
    if one_a_line and found:
        found = [tuple(found[0][0].replace(" - [", "\n- [").replace(" - m", "\n- m").split("\n"))]
    joined = {" ".join(form): form for form in found}
    return tuple(joined.values())
