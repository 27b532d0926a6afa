"""Programs made by hand, and an evaluator that shares no code with kanegen: instruction by instruction."""

import math
import struct

import numpy as np

from kanegen.artifacts import with_artifacts
from kanegen.c import ModelDescription, render
from kanegen.options import Variant
from kanegen.program.ir import Array, Instruction, Module, Op, Output, Program
from kanegen.program.precision import DOUBLE

OPERATIONS = {"add": 8, "multiply": 9, "divide": 1, "sqrt": 1, "sincos": 3}


class Listing:
    """Writes instructions one under the other; methods return numbers of values."""

    def __init__(self):
        self.instructions = []

    def __call__(self, op, *operands, **rest):
        self.instructions.append(Instruction(op, operands, **rest))
        return len(self.instructions) - 1

    def read(self, array, index, name=""):
        return self(Op.INPUT, array=array, index=index, name=name)

    def number(self, value):
        return self(Op.CONSTANT, number=value)

    def program(self, inputs, outputs):
        return Program(
            tuple(inputs),
            tuple(self.instructions),
            tuple(Output(array, tuple(values)) for array, values in outputs.items()),
        )


def array(name, *shape):
    return Array(name, shape, "SI", f"the array {name}, Eq. (1)")


X, Y, FORCE, TORQUE = array("x", 2), array("y", 2), array("force", 3, 3), array("torque", 3, 3)
PARAMETERS, PREPARED = array("parameters", 2), array("prepared", 2)
A, F = array("A", 2, 2), array("f", 2)


def mass_matrix(code, constants):
    x = [code.read("x", 0, "theta_1_1"), code.read("x", 1, "theta_1_2")]
    first, second = constants(code)
    bend = code(Op.COS, code(Op.SUBTRACT, *x), name="C_12", note="Body 1: a note with */ in it")
    mixed = code(Op.NEGATE, code(Op.MULTIPLY, second, bend))
    own = code(Op.ADD, code(Op.MULTIPLY, bend, bend), first)
    return [own, mixed, mixed, code.number(0.0)], bend


def forcing(code, bend, has_loads):
    y = [code.read("y", 0, "thetadot_1_1"), code.read("y", 1)]
    speed = code(Op.MULTIPLY, *y, name="yy_1", note="Body 2: speeds")
    root = code(Op.SQRT, code(Op.ADD, code(Op.MULTIPLY, speed, speed), code.number(2.5)))
    push = code(Op.DIVIDE, root, code(Op.SUBTRACT, code(Op.SIN, y[1]), code.number(3.0)))
    if has_loads:
        load = code(Op.SUBTRACT, code.read("force", 5, "F_2_3"), code.read("torque", 3))
        push = code(Op.ADD, push, load)
    return [code(Op.SUBTRACT, push, code(Op.MULTIPLY, bend, speed)), code(Op.NEGATE, push)]


def module(outputs=("mass_matrix", "forcing"), parameters=True, loads=True):
    """A system of three bodies and two freedoms; only body 2 takes loads."""

    def constants(code):
        if parameters:
            return code.read("prepared", 0), code.read("prepared", 1)
        return code.number(1.5), code.number(0.25)

    shared = [PREPARED] if parameters else []
    every = [*shared, X, Y, *([FORCE, TORQUE] if loads else [])]
    functions = {}
    if "mass_matrix" in outputs:
        code = Listing()
        functions["mass_matrix"] = code.program([*shared, X], {A: mass_matrix(code, constants)[0]})
    if "forcing" in outputs:
        code = Listing()
        _, bend = mass_matrix(code, constants)
        functions["forcing"] = code.program(every, {F: forcing(code, bend, loads)})
    if len(outputs) > 1:
        code = Listing()
        entries, bend = mass_matrix(code, constants)
        functions["evaluate"] = code.program(every, {A: entries, F: forcing(code, bend, loads)})
    return Module(prepare() if parameters else None, functions)


def prepare():
    code = Listing()
    mass, sine = code.read("parameters", 0, "p_m1"), code.read("parameters", 1, "p_sin")
    product = code(Op.MULTIPLY, mass, sine)
    return code.program([PARAMETERS], {PREPARED: [product, code(Op.ADD, product, code.number(1.0))]})


def description(name="handmade", parameters=True, loads=True):
    return ModelDescription(
        name=name,
        freedom_names=("arm.theta1", "elbow"),
        freedom_units=("rad", "m"),
        coordinate_names=("arm.theta1", "elbow"),
        coordinate_units=("rad", "m"),
        body_names=("arm", "tip-mass", "hand"),
        loaded=(False, loads, False),
        parameters=(("m1", 2.0), ("sin", 0.75)) if parameters else (),
    )


def source(
    name="handmade",
    outputs=("mass_matrix", "forcing"),
    parameters=True,
    loads=True,
    precision=DOUBLE,
    sincos="shared",
    storage="",
):
    operations = {**OPERATIONS, "prepare": 2 if parameters else 0}
    made = render(
        description(name, parameters, loads),
        module(outputs, parameters, loads),
        operations,
        Variant(precision.name, sincos=sincos, storage=storage),
    )
    return with_artifacts(made)


def many_states():
    """Return {x} and {y} of 5003 states: enough for several threads, and no multiple of any SIMD width."""
    return np.random.default_rng(5).normal(size=(2, 5003, 2))


def evaluate(program, number=np.float64, **inputs):
    """Outputs by name, flat, with every operation rounded on its own to the type `number`."""
    compute = {
        Op.ADD: lambda a, b: a + b,
        Op.SUBTRACT: lambda a, b: a - b,
        Op.MULTIPLY: lambda a, b: a * b,
        Op.DIVIDE: lambda a, b: a / b,
        Op.NEGATE: lambda a: -a,
        Op.ABS: np.abs,
        Op.SQRT: np.sqrt,
        Op.SIN: lambda a: math.sin(a) if math.isfinite(a) else math.nan,
        Op.COS: lambda a: math.cos(a) if math.isfinite(a) else math.nan,
        Op.SIGN: lambda a: a if a == 0 or math.isnan(a) else math.copysign(1.0, a),
        Op.MIN: lambda a, b: math.nan if math.isnan(a) or math.isnan(b) else b if b < a else a,
        Op.MAX: lambda a, b: math.nan if math.isnan(a) or math.isnan(b) else b if b > a else a,
        Op.SELECT: lambda c, a, b: math.nan if math.isnan(c) else a if c > 0 else b,
        Op.EXP: lambda a: np.exp(float(a)),
        Op.LOG: lambda a: np.log(float(a)),
        Op.TANH: lambda a: np.tanh(float(a)),
        Op.ATAN2: lambda a, b: np.arctan2(float(a) + 0.0, float(b) + 0.0),
    }
    values = []
    with np.errstate(all="ignore"):
        for i in program.instructions:
            if i.op is Op.INPUT:
                values.append(number(np.ravel(inputs[i.array])[i.index]))
            elif i.op is Op.CONSTANT:
                values.append(number(i.number))
            else:
                values.append(number(compute[i.op](*(values[j] for j in i.operands))))
    return {o.array.name: np.array([values[j] for j in o.values]) for o in program.outputs}


def bits(values):
    """Bit patterns, so that signs of zeros count; every NaN is the same."""
    return ["nan" if math.isnan(v) else struct.pack("<d", v).hex() for v in np.ravel(values)]
