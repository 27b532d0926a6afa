"""Programs of the outputs that are products with derivatives: Jacobian or Hessian times vector, gradients.

None of them forms a Jacobian. For {ydot} there are three ways, by `quantities`: implicitly, through inverse
dynamics; the same in components of angular velocities, where three angles of a joint can reach gimbal lock,
next to which products with [A]^-1 would lose digits that {ydot} has; or the solver itself, instruction by
instruction. Where {ydot} is refined the products are those of the refining solver, because [A] is then
ill-conditioned, and so they are where speeds or forces would change their meaning in components. Where
several bodies translate freely and rotate, which the solver never couples, the way with fewer operations is
taken.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from kanegen.lowering.definitions import lower_definitions
from kanegen.lowering.embedded import Column, Embedded
from kanegen.lowering.quantities import (
    ACCELERATION,
    BIAS,
    EFFORTS,
    SPEEDS,
    Explicit,
    InComponents,
    Quantity,
    Solved,
)
from kanegen.lowering.second_derivatives import second_derivatives
from kanegen.model.coordinates import SPEEDS as SPEED_CHOICES
from kanegen.model.force_elements.names import referenced_variables
from kanegen.model.system import System
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.constants import Constants
from kanegen.program.count import count
from kanegen.program.ir import Array, Output, Program
from kanegen.program.orders import depth_first
from kanegen.program.passes.fold import FoldingBuilder, fold
from kanegen.program.passes.prune import prune
from kanegen.program.split import joined
from kanegen.recursion import RecursiveForm, derive
from kanegen.recursion.angular_components import (
    angle_accelerations,
    angular_speeds,
    places_of_angles,
    torques,
)
from kanegen.recursion.outputs import OUTPUTS, PRODUCTS, SECOND_DERIVATIVES, argument_arrays, input_arrays
from kanegen.recursion.outputs.differentiated import Product
from kanegen.recursion.tree import Derived, tree


def with_products(
    found: Program,
    program: Program,
    form: RecursiveForm,
    outputs: Mapping[str, Output],
    names: Sequence[str],
    constants: Constants,
) -> Program:
    """Return the program with the outputs `names`, of which some are products or second derivatives.

    Args:
        found: Program of those that are not.
        program: Program of the outputs that are differentiated, among others.
        form: What it was lowered from.
        outputs: Outputs of this program, by name.
        names: Names of the outputs of the result, in order.
        constants: The arithmetic of constants.
    """
    programs = [
        Making(program, form, outputs, constants, name).least()
        if name in PRODUCTS
        else second_derivatives(program, form, outputs, constants, name)
        for name in names
        if name in (*PRODUCTS, *SECOND_DERIVATIVES)
    ]
    if not programs:
        return found
    arrays = [OUTPUTS[name].array(form.system).name for name in names]
    return joined([found, *programs], [array.name for array in argument_arrays(form.system)], arrays)


@dataclass(frozen=True)
class Making:
    """The making of the program of a product.

    Attributes:
        program: Program of the outputs that are differentiated, among others.
        form: What it was lowered from.
        outputs: Outputs of this program, by name.
        constants: The arithmetic of constants.
        name: Name of the product.
    """

    program: Program
    form: RecursiveForm
    outputs: Mapping[str, Output]
    constants: Constants
    name: str

    def least(self) -> Program:
        """Return the program with the fewest operations among those of the ways that lose no digits."""
        programs = [self._program(way) for way in self._ways()]
        return min(programs, key=lambda one: sum(count(one).values()))

    def _ways(self) -> Iterator[str]:
        """Yield the ways to differentiate."""
        system = self.form.system
        joints = [body.joint for body in system.bodies]
        is_implicit = "forward_dynamics" in self._product.needs and not self.form.refinement.steps
        if is_implicit and not places_of_angles(system):
            yield "solved"
        elif is_implicit and _has_regular_speeds(system):
            yield "components"
        else:
            yield "explicit"
            return
        if sum(all(joint.free[3:]) and any(joint.free[:3]) for joint in joints) > 1:
            yield "explicit"

    @property
    def _product(self) -> Product:
        return PRODUCTS[self.name]

    def _program(self, way: str) -> Program:
        """Return the program of the product by one way."""
        system = self.form.system
        builder = FoldingBuilder(argument_arrays(system))
        base = self._differentiated(self._product.needs[-1])
        quantity = self._quantity(builder, way)
        conditions = Embedded(builder, base, self.constants, {}).output(base.outputs[0].array.name)
        values = self._values(builder, quantity, base.outputs[0].array.name)
        zero = builder.constant(self.constants.quotient(0, 1))
        output = replace(
            conditions,
            array=OUTPUTS[self.name].array(system),
            values=tuple(zero if value is None else value for value in values),
        )
        return prune(check(builder.program([output])))

    def _quantity(self, builder: Builder, way: str) -> Quantity:
        """Return the quantity that is differentiated, in a builder."""
        by, constants, needs = tuple(self._columns), self.constants, self._product.needs
        programs = [self._differentiated(name) for name in needs]
        if way == "explicit":
            return Explicit(builder, programs[-1], constants, by, {})
        if way == "solved":
            return Solved(builder, programs[-1], programs[0], constants, by, {})
        system = self.form.system
        regular = system.with_speeds(SPEED_CHOICES[1])
        method = self.form.methods["forward_dynamics"]
        form = derive(regular, {needs[0]: self.form.methods[needs[0]], needs[-1]: method}, constants)
        arrays = {OUTPUTS[name].array(regular): found for name, found in form.outputs.items()}
        lowered = lower_definitions(input_arrays(regular), form.definitions, arrays, constants)
        inverse, solver = (_alone(lowered, output) for output in lowered.outputs)
        before, after = _maps(system, constants)
        return InComponents(builder, before, solver, inverse, after, constants, by)

    def _differentiated(self, name: str) -> Program:
        """Return the program of an output that is differentiated, folded."""
        return _alone(self.program, self.outputs[name])

    @property
    def _columns(self) -> dict[str, slice]:
        """Places of the variables, by array."""
        return self._product.columns_of(self.form.system)

    def _values(self, builder: Builder, quantity: Quantity, name: str) -> Column:
        """Return the elements of the product."""
        kind, n = self._product.kind, len(self.form.system.freedoms)
        direction: dict[str, Column] = {}
        weights: dict[str, Column] = {}
        if kind.is_directed:
            for array, places in self._columns.items():
                direction[array] = [
                    builder.input(self._product.direction, i) for i in range(places.start, places.stop)
                ]
        if not kind.is_weighted:
            return quantity.along(direction)[name]
        weights[name] = [builder.input("weights", i) for i in range(n)]
        if kind.is_directed:
            found = quantity.gradient_along(weights, {}, direction)
        else:
            found = quantity.gradient(weights)
        result: Column = [None] * self._product.width(self.form.system)
        for array, places in self._columns.items():
            if array in found:
                result[places] = found[array]
        return result


def _alone(program: Program, output: Output) -> Program:
    """Return the program of one output, folded, so that equal values have one adjoint.

    Its order follows from itself, so that nothing else in the program changes the derivatives.
    """
    bare = replace(output, array=replace(output.array, doc=""))
    return prune(fold(depth_first(prune(replace(program, outputs=(bare,))))))


def _has_regular_speeds(system: System) -> bool:
    """Return whether angular velocities may replace the rates of three angles at every joint that has them.

    They may not where a force element, a coupling, a rotor or an armature belongs to one of these angles.
    """
    named = referenced_variables(system.force_elements)
    driving = {one.freedom.body for one in system.mounted_rotors}
    coupled = {freedom.body for freedom in system.in_couplings}
    for k, body in enumerate(system.bodies, start=1):
        joint = body.joint
        if joint.has_free_orientation and joint.speeds_are_rates:
            acting = any(name.startswith(f"y.{body.name}.theta") for name in named)
            if acting or k in driving or k in coupled or any(joint.armature[:3]):
                return False
    return True


def _maps(system: System, constants: Constants) -> tuple[Program, Program]:
    """Return the map from {x}, {y} and {tau} to components of angular velocities, and the one to {ydot}."""
    n = len(system.freedoms)
    prepared = tree(system, constants)

    def lowered(**derived: Derived) -> Program:
        arrays = {Array(name, (n,), "", ""): one for name, one in derived.items()}
        definitions = prepared.definitions.listed()
        return fold(lower_definitions(input_arrays(system), definitions, arrays, constants))

    after = prune(lowered(**{ACCELERATION: angle_accelerations(prepared)}))
    prepared = tree(system, constants)
    first = prune(lowered(**{SPEEDS: angular_speeds(prepared), EFFORTS: torques(prepared)}))
    return _with_bias(first, system, constants), after


def _with_bias(program: Program, system: System, constants: Constants) -> Program:
    """Return the program of [P]{y} and [P]^-T {tau} with [dP/dt]{y} as third output."""
    builder = FoldingBuilder(program.inputs)
    embedded = Embedded(builder, program, constants, {})
    rates: Column = [None] * len(system.coordinates)
    for coordinate, speed in places_of_angles(system):
        rates[coordinate] = builder.input("y", speed)
    found = embedded.tangents({"x": rates}, [SPEEDS])[SPEEDS]
    zero = builder.constant(constants.quotient(0, 1))
    bias = Output(Array(BIAS, (len(found),), "", ""), tuple(zero if v is None else v for v in found))
    return prune(builder.program([embedded.output(SPEEDS), embedded.output(EFFORTS), bias]))
