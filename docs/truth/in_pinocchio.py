"""Builds the trees of this folder in Pinocchio, from the files alone, and prints its errors.

python docs/truth/in_pinocchio.py
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

FOLDER = Path(__file__).parent


def main() -> None:
    """Print the largest errors of [A], {f} and {ydot}, each over the largest entry."""
    for path in sorted(FOLDER.glob("*.json")):
        print(path.stem, *(f"{error:.1e}" for error in errors(path)))


def errors(path: Path) -> tuple[float, float, float]:
    """Return the largest errors of [A], {f} and {ydot} in all states of a file."""
    tree = json.loads(path.read_text(encoding="utf-8"))
    model, largest = Tree(tree), np.zeros(3)
    for state in tree["states"]:
        x, y, lower, *exact = (numbers(state[key]) for key in ("x", "y", "A", "f", "ydot"))
        a, f = model.dynamics(x, y)
        found = [a[np.tril_indices(len(y))], f, np.linalg.solve(a, f)]
        for i, (mine, theirs) in enumerate(zip(found, (lower, *exact), strict=True)):
            largest[i] = max(largest[i], np.abs(mine - theirs).max() / np.abs(theirs).max())
    return tuple(largest.tolist())


def numbers(texts: list[str]) -> np.ndarray:
    """Return numbers that are hexadecimal or decimal texts."""
    return np.array([number(text) for text in texts])


def number(text: str) -> float:
    """Return a number that is a hexadecimal or decimal text."""
    return float.fromhex(text) if "x" in text else float(text)


class Tree:
    """A tree with one joint of Pinocchio for every entry of `joint`; a projection holds couplings."""

    def __init__(self, tree: dict[str, Any]) -> None:
        """Build the model of a file."""
        self.model = pin.Model()
        self.model.gravity.linear = numbers(tree["gravity"])
        self.freedoms = len(tree["speeds"])
        self.moves: list[tuple[int, dict[str, Any]]] = []
        joints = {0: 0}
        for k, body in enumerate(tree["bodies"], start=1):
            turned = numbers(body["orientation"]).reshape(3, 3)
            placement = pin.SE3(turned.T, numbers(body["position"]))
            joint = joints[body["lower"]]
            for move in body["joint"]:
                joint = self.model.addJoint(joint, _joint(move), placement, f"{k}.{len(self.moves)}")
                self.moves.append((joint, move))
                placement = pin.SE3.Identity()
            inertia = numbers(body["inertia"]).reshape(3, 3)
            moving = pin.Inertia(number(body["mass"]), numbers(body["mass_center"]), inertia)
            self.model.appendBodyToJoint(joint, moving, placement)
            joints[k] = joint

    def dynamics(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (n, n) [A] and (n,) {f} in the order of the file."""
        q, projection = pin.neutral(self.model), np.zeros((self.model.nv, self.freedoms))
        for joint, move in self.moves:
            at, to = self.model.joints[joint].idx_q, self.model.joints[joint].idx_v
            if "quaternion" in move:
                scalar, *vector = x[move["quaternion"]] / np.linalg.norm(x[move["quaternion"]])
                q[at : at + 4] = *vector, scalar
                projection[range(to, to + 3), move["y"]] = 1
            else:
                factor, offset = number(move.get("factor", "1")), number(move.get("offset", "0"))
                q[at] = factor * x[move["x"]] + offset
                projection[to, move["y"]] = factor
        data = self.model.createData()
        upper = np.triu(pin.crba(self.model, data, q))
        a = upper + np.triu(upper, 1).T
        bias = pin.nonLinearEffects(self.model, data, q, projection @ y)
        return projection.T @ a @ projection, -projection.T @ bias


def _joint(move: dict[str, Any]) -> Any:
    """Return the joint of Pinocchio for one entry of `joint`."""
    if "quaternion" in move:
        return pin.JointModelSpherical()
    letter, axis = ("P", move["slide"]) if "slide" in move else ("R", move["turn"])
    return getattr(pin, f"JointModel{letter}{'XYZ'[axis - 1]}")()


if __name__ == "__main__":
    main()
