"""Actuators of a compiled MJCF model as drives, each with its control as a parameter.

The force of an actuator is (g0 + g1 l + g2 v) u + b0 + b1 l + b2 v, with its length l, the rate v of the
length, and its input u, which is the control, or the activation where the actuator has a state of its own.
Motors, position and velocity servos, dampers and filtered ones have this form; muscles have not.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from kanegen.model.force_elements.elements import Drive
from kanegen.model.force_elements.grammar import parse
from kanegen.model.names import MAX_IDENTIFIER
from kanegen.model.numbers import Parameter
from kanegen.readers.mjcf_compiled import JOINT_TYPES, Compiled
from kanegen.readers.mjcf_left_out import LeftOut
from kanegen.readers.mjcf_lengths import Length, joint_length, sum_of, tendon_length
from kanegen.readers.mjcf_tree import MjcfTree

CONTROL, ACTIVATION = "ctrl_", "act_"
"""What the name of the parameter of an actuator begins with."""


def actuators(model: Compiled, tree: MjcfTree) -> Iterator[Drive | LeftOut]:
    """Yield the drives of the actuators, and those actuators that are left out."""
    compiled = model.model
    numbers = range(int(compiled.nactuator))
    if model.disables("ACTUATION"):
        return
    lengths = {number: _length(model, tree, number) for number in numbers}
    without = [number for number in numbers if lengths[number] is None or not _is_linear(model, number)]
    linear = [number for number in numbers if number not in without]
    taken: set[str] = set()
    for number in linear:
        length = lengths[number]
        assert length is not None
        yield from _drives(model, number, length, _parameter(model, number, taken))
    reason = "which are no linear functions of an input, lengths and their rates"
    yield LeftOut("forces", "other actuator", model.names("actuator", without), reason)
    stateful = [number for number in linear if _has_state(model, number)]
    yield LeftOut("states", "actuator", model.names("actuator", stateful), "whose activations are inputs")
    clamped = [number for number in linear if compiled.actuator_forcelimited[number]]
    yield LeftOut("bounds of the forces", "actuator", model.names("actuator", clamped))
    late = [number for number in linear if compiled.actuator_delay[number]]
    yield LeftOut("delays", "actuator", model.names("actuator", late))


def _length(model: Compiled, tree: MjcfTree, number: int) -> Length | None:
    """Return the length along which an actuator acts, or None if its rate is no constant sum of speeds."""
    compiled, kinds = model.model, model.mujoco.mjtTrn
    gear = compiled.actuator_gear[compiled.actuator_outadr[number]]
    target, kind = int(compiled.actuator_trnid[number][0]), int(compiled.actuator_trntype[number])
    if kind == int(kinds.mjTRN_TENDON):
        length = tendon_length(model, tree, target)
        return length and length.scaled(float(gear[0]))
    in_parent = kind == int(kinds.mjTRN_JOINTINPARENT)
    is_scalar = in_parent and JOINT_TYPES[int(compiled.jnt_type[target])] in ("slide", "hinge")
    return joint_length(model, tree, target, gear) if kind == int(kinds.mjTRN_JOINT) or is_scalar else None


def _is_linear(model: Compiled, number: int) -> bool:
    """Return whether the force of an actuator has the form of this module."""
    compiled, mujoco = model.model, model.mujoco
    gains = (mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtGain.mjGAIN_AFFINE)
    biases = (mujoco.mjtBias.mjBIAS_NONE, mujoco.mjtBias.mjBIAS_AFFINE)
    dynamics = (mujoco.mjtDyn.mjDYN_NONE, *_dynamics(model))
    is_scalar = int(compiled.actuator_ctrlnum[number]) == 1 == int(compiled.actuator_outnum[number])
    target = int(compiled.actuator_trnid[number][0])
    of_joint = int(compiled.actuator_trntype[number]) != int(mujoco.mjtTrn.mjTRN_TENDON)
    has_length = not of_joint or JOINT_TYPES[int(compiled.jnt_type[target])] in ("slide", "hinge")
    needs_length = bool(_gain(model, number)[1] or _bias(model, number)[1])
    group = int(compiled.actuator_group[number])
    return (
        is_scalar
        and int(compiled.actuator_gaintype[number]) in map(int, gains)
        and int(compiled.actuator_biastype[number]) in map(int, biases)
        and int(compiled.actuator_dyntype[number]) in map(int, dynamics)
        and int(compiled.actuator_plugin[number]) < 0
        and (has_length or not needs_length)
        and not (0 <= group < 31 and int(compiled.opt.disableactuator) >> group & 1)
    )


def _dynamics(model: Compiled) -> tuple[int, ...]:
    """Return the types of linear dynamics of an activation."""
    kinds = model.mujoco.mjtDyn
    return int(kinds.mjDYN_INTEGRATOR), int(kinds.mjDYN_FILTER), int(kinds.mjDYN_FILTEREXACT)


def _has_state(model: Compiled, number: int) -> bool:
    """Return whether an actuator has an activation."""
    return int(model.model.actuator_dyntype[number]) in _dynamics(model)


def _gain(model: Compiled, number: int) -> tuple[float, float, float]:
    """Return g0, g1, g2."""
    first, second, third = (float(value) for value in model.model.actuator_gainprm[number][:3])
    is_affine = int(model.model.actuator_gaintype[number]) == int(model.mujoco.mjtGain.mjGAIN_AFFINE)
    return (first, second, third) if is_affine else (first, 0.0, 0.0)


def _bias(model: Compiled, number: int) -> tuple[float, float, float]:
    """Return b0, b1, b2."""
    first, second, third = (float(value) for value in model.model.actuator_biasprm[number][:3])
    is_affine = int(model.model.actuator_biastype[number]) == int(model.mujoco.mjtBias.mjBIAS_AFFINE)
    return (first, second, third) if is_affine else (0.0, 0.0, 0.0)


def _parameter(model: Compiled, number: int, taken: set[str]) -> Parameter:
    """Return the input of an actuator as a parameter with the value 0 and a name that is not taken."""
    kind = ACTIVATION if _has_state(model, number) else CONTROL
    base = re.sub(r"[^A-Za-z0-9_]", "_", kind + model.name("actuator", number))[: MAX_IDENTIFIER - 4]
    name, count = base, 1
    while name in taken:
        count += 1
        name = f"{base}_{count}"
    taken.add(name)
    return Parameter(name, 0.0)


def _drives(model: Compiled, number: int, length: Length, control: Parameter) -> Iterator[Drive]:
    """Yield the drives by which an actuator acts on freedoms."""
    gains = _combination(_gain(model, number), length)
    biases = _combination(_bias(model, number), length)
    terms = [(factor, f"{control.name}*{text}" if text else control.name) for factor, text in gains] + biases
    for factor, name in length.speeds:
        effort = sum_of((factor * coefficient, text) for coefficient, text in terms)
        if effort != "0":
            yield Drive(name, parse(effort, [control]))


def _combination(factors: tuple[float, float, float], length: Length) -> list[tuple[float, str]]:
    """Return the terms of c0 + c1 l + c2 v."""
    constant, position, speed = factors
    return [
        (constant, ""),
        *((position * coefficient, text) for coefficient, text in length.value),
        *((speed * coefficient, text) for coefficient, text in length.rate),
    ]
