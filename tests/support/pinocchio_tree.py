"""The same tree as a Pinocchio model: an implementation of rigid-body dynamics that shares no code with ours.

Every free freedom becomes one prismatic or revolute joint, in the order translations 1, 2, 3, then angles in
their sequence; locked ones become part of the next placement.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from kanegen.model.arrays import SystemArrays
from kanegen.model.coordinates import SEQUENCES
from kanegen.model.system import System

Floats = NDArray[np.float64]


class PinocchioTree:
    """[A] and {f} of a system in the order of {x}, computed by `crba` and `rnea`."""

    outputs = ("mass_matrix", "forcing")

    def __init__(self, system: System | SystemArrays) -> None:
        self.arrays = system.values() if isinstance(system, System) else system
        self.model = pin.Model()
        self.model.gravity.linear = self.arrays.gravity
        self.carrier: dict[int, tuple[int, Any]] = {0: (0, pin.SE3.Identity())}  # joint, placement of body
        self.joint_of: dict[tuple[int, int], int] = {}
        for k in _depth_first(list(self.arrays.connection)):
            self._add(k)
        self.data = self.model.createData()
        order = [(k, i) for part in ((0, 1, 2), (3, 4, 5)) for k in range(self.count) for i in part]
        joints = [self.joint_of[key] for key in order if key in self.joint_of]
        self.columns = [self.model.joints[joint].idx_v for joint in joints]

    @property
    def count(self) -> int:
        """N."""
        return len(self.arrays.mass)

    def _add(self, k: int) -> None:
        a = self.arrays
        joint, lower = self.carrier[int(a.connection[k])]
        placement = lower * pin.SE3(a.joint_orientation[k].T, a.joint_position[k])
        axes = (*SEQUENCES[a.sequence[k]], 3, 4, 5)
        for freedom in (3, 4, 5, 0, 1, 2):
            if a.free[k, freedom]:
                joint = self.model.addJoint(joint, _joint(axes[freedom]), placement, f"{k}.{freedom}")
                self.joint_of[k, freedom] = joint
                self.model.armature[self.model.joints[joint].idx_v] = a.armature[k, freedom]
                placement = pin.SE3.Identity()
            else:
                placement = placement * _displacement(axes[freedom], a.locked[k, freedom])
        self.model.appendBodyToJoint(joint, pin.Inertia(a.mass[k], a.mass_center[k], a.inertia[k]), placement)
        self.carrier[k + 1] = joint, placement

    def mass_matrix(self, x: Any) -> Floats:
        """(n, n) or (B, n, n)."""
        x = np.asarray(x)
        if x.ndim > 1:
            return np.array([self.mass_matrix(row) for row in x])
        upper = np.triu(pin.crba(self.model, self.data, self._in_their_order(x)))
        matrix: Floats = (upper + np.triu(upper, 1).T)[np.ix_(self.columns, self.columns)]
        return matrix

    def forcing(self, x: Any, y: Any, force: Any = None, torque: Any = None) -> Floats:
        """(n,) or (B, n)."""
        x, y = np.asarray(x), np.asarray(y)
        shape = (*x.shape[:-1], self.count, 3)
        forces = np.broadcast_to(np.zeros(3) if force is None else force, shape)
        torques = np.broadcast_to(np.zeros(3) if torque is None else torque, shape)
        if x.ndim > 1:
            return np.array([self.forcing(*row) for row in zip(x, y, forces, torques, strict=True)])
        external = pin.StdVec_Force([pin.Force.Zero() for _ in range(self.model.njoints)])
        for k in range(self.count):
            joint, placement = self.carrier[k + 1]
            moment = torques[k] + np.cross(self.arrays.mass_center[k], forces[k])
            external[joint] += placement.act(pin.Force(forces[k], moment))
        q, v = self._in_their_order(x), self._in_their_order(y)
        result: Floats = -pin.rnea(self.model, self.data, q, v, np.zeros_like(v), external)[self.columns]
        return result

    def gravity_forces(self, x: Any) -> Floats:
        """(n,) part of {f} that gravity causes."""
        gravity: Floats = -pin.computeGeneralizedGravity(self.model, self.data, self._in_their_order(x))
        return gravity[self.columns]

    def coriolis_matrix(self, x: Any, y: Any) -> Floats:
        """(n, n) [C]; the speeds must be rates."""
        q, v = self._in_their_order(x), self._in_their_order(y)
        found: Floats = pin.computeCoriolisMatrix(self.model, self.data, q, v)
        return found[np.ix_(self.columns, self.columns)]

    def _in_their_order(self, values: Floats) -> Floats:
        result = np.empty_like(values)
        result[self.columns] = values
        return result


def _depth_first(connection: list[int]) -> list[int]:
    """Bodies, counted from 0, with every subtree contiguous, as `crba` needs it."""
    order: list[int] = []
    waiting = [k for k, lower in enumerate(connection) if lower == 0]
    while waiting:
        order.append(waiting.pop())
        waiting += [k for k, lower in enumerate(connection) if lower == order[-1] + 1]
    return order


def _joint(kind: int) -> Any:
    """Turns about the axes 0, 1, 2, or slides along them as 3, 4, 5."""
    return getattr(pin, f"JointModel{'P' if kind >= 3 else 'R'}{'XYZ'[kind % 3]}")()


def _displacement(kind: int, value: float) -> Any:
    """Placement of a joint locked at `value`."""
    axis = np.eye(3)[kind % 3]
    if kind >= 3:
        return pin.SE3(np.eye(3), value * axis)
    return pin.SE3(pin.AngleAxis(value, axis).matrix(), np.zeros(3))
