"""Actuators of a compiled MJCF model as drives and loads, each with its control as a parameter.

The force of an actuator is (g0 + g1 l + g2 v) u + b0 + b1 l + b2 v, with its length l, the rate v of the
length, and its input u, which is the control, or the activation where the actuator has a state of its own.
Motors, position and velocity servos, dampers and filtered ones have this form; muscles have not.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from kanegen.model.force_elements.elements import Drive, PointLoad
from kanegen.model.grammar import parse
from kanegen.model.names import MAX_IDENTIFIER
from kanegen.model.numbers import Parameter
from kanegen.readers.mjcf_compiled import JOINT_TYPES, Compiled
from kanegen.readers.mjcf_left_out import LeftOut
from kanegen.readers.mjcf_lengths import Length, joint_length, sum_of, tendon_length
from kanegen.readers.mjcf_tree import MjcfTree

CONTROL, ACTIVATION = "ctrl_", "act_"
"""What the name of the parameter of an actuator begins with."""


def actuators(model: Compiled, tree: MjcfTree) -> Iterator[Drive | PointLoad | LeftOut]:
    """Yield the drives of actuators, the loads of those at sites, and the actuators that are left out."""
    compiled = model.model
    if model.disables("ACTUATION"):
        return
    linear, without = [], []
    taken: set[str] = set()
    for number in range(int(compiled.nactuator)):
        if _is_disabled(model, number):
            continue
        length, site = _length(model, tree, number), _site(model, tree, number)
        if not _is_linear(model, number, length) or (length is None and site is None):
            without.append(number)
            continue
        linear.append(number)
        control = _parameter(model, number, taken)
        if length is not None:
            yield from _drives(model, number, length, control)
        elif site is not None and _carrier(model, number) in tree.moving:
            yield _thrust(model, number, site, control)
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


def _site(model: Compiled, tree: MjcfTree, number: int) -> str | None:
    """Return the frame of the site at which an actuator acts; None if it acts elsewhere or between sites."""
    compiled = model.model
    site, reference = (int(target) for target in compiled.actuator_trnid[number])
    is_at_site = int(compiled.actuator_trntype[number]) == int(model.mujoco.mjtTrn.mjTRN_SITE)
    return tree.sites.get(site) if is_at_site and reference < 0 else None


def _carrier(model: Compiled, number: int) -> int:
    """Return the number of the body with the site at which an actuator acts."""
    return int(model.model.site_bodyid[model.model.actuator_trnid[number][0]])


def _is_linear(model: Compiled, number: int, length: Length | None) -> bool:
    """Return whether the force of an actuator has the form of this module, by the length that it has."""
    compiled, mujoco = model.model, model.mujoco
    gains = (mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtGain.mjGAIN_AFFINE)
    biases = (mujoco.mjtBias.mjBIAS_NONE, mujoco.mjtBias.mjBIAS_AFFINE)
    dynamics = (mujoco.mjtDyn.mjDYN_NONE, *_dynamics(model))
    is_scalar = int(compiled.actuator_ctrlnum[number]) == 1 == int(compiled.actuator_outnum[number])
    (_, by_length, by_rate), (_, of_length, of_rate) = _gain(model, number), _bias(model, number)
    needs_length, needs_rate = bool(by_length or of_length), bool(by_rate or of_rate)
    return (
        is_scalar
        and int(compiled.actuator_gaintype[number]) in map(int, gains)
        and int(compiled.actuator_biastype[number]) in map(int, biases)
        and int(compiled.actuator_dyntype[number]) in map(int, dynamics)
        and int(compiled.actuator_plugin[number]) < 0
        and not (needs_length and not (length and length.coordinates))
        and not (needs_rate and not length)
    )


def _is_disabled(model: Compiled, number: int) -> bool:
    """Return whether the file switches off the group of an actuator."""
    group = int(model.model.actuator_group[number])
    return 0 <= group < 31 and bool(int(model.model.opt.disableactuator) >> group & 1)


def _dynamics(model: Compiled) -> tuple[int, ...]:
    """Return the types of linear dynamics of an activation."""
    kinds = model.mujoco.mjtDyn
    return int(kinds.mjDYN_INTEGRATOR), int(kinds.mjDYN_FILTER), int(kinds.mjDYN_FILTEREXACT)


def _has_state(model: Compiled, number: int) -> bool:
    """Return whether an actuator has an activation."""
    return int(model.model.actuator_dyntype[number]) in _dynamics(model)


def _gain(model: Compiled, number: int) -> tuple[float, float, float]:
    """Return g0, g1, g2 of an actuator: its gain is g0 + g1 length + g2 velocity."""
    first, second, third = (float(value) for value in model.model.actuator_gainprm[number][:3])
    is_affine = int(model.model.actuator_gaintype[number]) == int(model.mujoco.mjtGain.mjGAIN_AFFINE)
    return (first, second, third) if is_affine else (first, 0.0, 0.0)


def _bias(model: Compiled, number: int) -> tuple[float, float, float]:
    """Return b0, b1, b2 of an actuator: its bias force is b0 + b1 length + b2 velocity."""
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


def _thrust(model: Compiled, number: int, site: str, control: Parameter) -> PointLoad:
    """Return the force and the moment by which an actuator acts at a site, in components of its frame."""
    (gain, _, _), (bias, _, _) = _gain(model, number), _bias(model, number)
    gear = model.model.actuator_gear[model.model.actuator_outadr[number]]
    wrench = [
        parse(sum_of([(float(factor) * gain, control.name), (float(factor) * bias, "")]), [control])
        for factor in gear
    ]
    force, moment = (wrench[0], wrench[1], wrench[2]), (wrench[3], wrench[4], wrench[5])
    return PointLoad(site, force, moment, frame=site)


def _combination(factors: tuple[float, float, float], length: Length) -> list[tuple[float, str]]:
    """Return the terms of c0 + c1 l + c2 v."""
    constant, position, speed = factors
    return [
        (constant, ""),
        *((position * coefficient, text) for coefficient, text in length.value),
        *((speed * coefficient, text) for coefficient, text in length.rate),
    ]
