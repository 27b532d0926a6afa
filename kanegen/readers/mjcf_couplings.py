"""Linear equalities of joints and fixed tendons in a compiled MJCF model: couplings, and locked freedoms.

MuJoCo holds an equality by a force, as stiff as the file says; here it holds exactly.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kanegen.model.coupling import Coupling
from kanegen.readers.mjcf_compiled import Compiled
from kanegen.readers.mjcf_left_out import LeftOut
from kanegen.readers.mjcf_lengths import joint_length, tendon_length
from kanegen.readers.mjcf_tree import MjcfTree

Locked = tuple[str, float]
"""Name of a freedom and the value at which it is locked (rad, m)."""


def couplings(model: Compiled, tree: MjcfTree) -> Iterator[Coupling | Locked | LeftOut]:
    """Yield the couplings and locked freedoms of a model, and the equalities that are left out."""
    compiled = model.model
    if model.disables("EQUALITY"):
        return
    without: dict[str, list[int]] = {}
    driven: set[str] = set()
    for number in range(int(compiled.neq)):
        kind = str(model.mujoco.mjtEq(int(compiled.eq_type[number])).name).removeprefix("mjEQ_").lower()
        if not compiled.eq_active0[number]:
            without.setdefault(f"inactive {kind}", []).append(number)
        elif kind not in ("joint", "tendon"):
            without.setdefault(kind, []).append(number)
        elif (equation := _equation(model, tree, kind, number)) is None:
            without.setdefault(f"nonlinear {kind}", []).append(number)
        elif not (free := [name for name in equation.factors if name not in driven]):
            without.setdefault(f"further {kind}", []).append(number)
        else:
            driven.add(free[0])
            yield equation.solved(free[0])
    for kind, numbers in without.items():
        names = model.names("equality", numbers)
        yield LeftOut("constraints", f"{kind} equality", names, plural=f"{kind} equalities")


@dataclass(frozen=True)
class _Equation:
    """A linear equation of coordinates: sum of f_i x_i = value.

    Attributes:
        factors: Factor f_i of each coordinate by its name, none of them zero.
        value: The right side.
    """

    factors: dict[str, float]
    value: float

    def solved(self, name: str) -> Coupling | Locked:
        """Return the coordinate `name` as a function of the others, or its value if there are none."""
        own = self.factors[name]
        terms = {other: -factor / own for other, factor in self.factors.items() if other != name}
        return Coupling(name, terms, self.value / own) if terms else (name, self.value / own)


def _equation(model: Compiled, tree: MjcfTree, kind: str, number: int) -> _Equation | None:
    """Return the equation l_1 - l_1,0 = c0 + c1 (l_2 - l_2,0), or None if an equality is not linear.

    The lengths l are those of two joints or fixed tendons, l_1,0 and l_2,0 their values at the reference
    coordinates; there may be no second one.
    """
    compiled = model.model
    if any(compiled.eq_data[number][2:5]):
        return None
    constant, slope = (float(value) for value in compiled.eq_data[number][:2])
    second = int(compiled.eq_obj2id[number])
    ends = [(1.0, int(compiled.eq_obj1id[number]))] + ([(-slope, second)] if second >= 0 and slope else [])
    factors: dict[str, float] = {}
    value = constant
    for sign, end in ends:
        length = (
            joint_length(model, tree, end, (1.0,)) if kind == "joint" else tendon_length(model, tree, end)
        )
        if length is None:
            return None
        for factor, name in length.coordinates:
            factors[name] = factors.get(name, 0.0) + sign * factor
            value += sign * factor * float(compiled.qpos0[tree.coordinates.index(name)])
    return _Equation({name: factor for name, factor in factors.items() if factor}, value)
