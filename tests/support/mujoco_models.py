"""Models of MuJoCo: files, MuJoCo's own dynamics in the order of kanegen's {x} and {y}, and random models.

MuJoCo is imported when it is used, so that tests of other things run without it.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import kanegen as kg
from kanegen import extras
from kanegen.errors import KanegenWarning
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.reference.equations import forcing, mass_matrix

DATA = Path(__file__).parents[1] / "readers" / "data" / "mjcf"
"""Model files of gymnasium (MIT licence) and of dm_control (Apache licence), unchanged."""

MODELS = sorted(DATA.glob("*/*.xml"))
"""Every model; files that only other models include are in the folder `common`."""


TOLERANCE = 1e-11
"""Of rounding errors: MuJoCo and the reference differ by the errors of some hundred operations, in the file
with the lightest parts by 6e-13 of the largest value."""


class MujocoModel:
    """A model in MuJoCo, without contacts, limits and all else that kanegen says that it leaves out.

    Attributes:
        model: The `mujoco.MjModel`.
        data: The `mujoco.MjData`: the state.
        coordinates: (nq,) place in {x} of each element of `qpos`.
        speeds: (nv,) place in {y} of each element of `qvel`.
    """

    def __init__(self, path: Path, system: System) -> None:
        self._mujoco = extras.module("mujoco", extra=extras.MUJOCO)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.model = self._mujoco.MjSpec.from_file(str(path)).compile()
        _leave_out(self._mujoco, self.model)
        self.data = self._mujoco.MjData(self.model)
        self.coordinates, self.speeds = _places(self.model, system)

    def draw_state(self, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """Take a random state and random inputs of the actuators; return {x} and {y}."""
        model, data = self.model, self.data
        data.qpos[:] = rng.uniform(-1.5, 1.5, model.nq)
        data.qvel[:] = rng.normal(size=model.nv)
        data.ctrl[:], data.act[:] = rng.normal(size=model.nu), rng.normal(size=model.na)
        self._mujoco.mj_normalizeQuat(model, data.qpos)
        self._mujoco.mj_forward(model, data)
        x, y = np.empty(model.nq), np.empty(model.nv)
        x[self.coordinates], y[self.speeds] = data.qpos, data.qvel
        return x, y

    def equalities(self, x: Floats) -> tuple[Floats, Floats]:
        """Residuals of the linear equalities of joints and tendons at {x}, and their Jacobian by {y}."""
        model, data = self.model, self.data
        model.opt.disableflags = 0
        linear = (int(self._mujoco.mjtEq.mjEQ_JOINT), int(self._mujoco.mjtEq.mjEQ_TENDON))
        data.eq_active[:] &= np.isin(model.eq_type, linear) & ~np.any(model.eq_data[:, 2:5], axis=1)
        data.qpos[:] = x[self.coordinates]
        self._mujoco.mj_forward(model, data)
        jacobian = np.zeros((data.nefc, model.nv))
        self._mujoco.mju_sparse2dense(
            jacobian, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind
        ) if self._mujoco.mj_isSparse(model) else np.copyto(jacobian, data.efc_J.reshape(jacobian.shape))
        by_y = np.zeros((data.ne, model.nv))
        by_y[:, self.speeds] = jacobian[: data.ne]
        return np.array(data.efc_pos[: data.ne]), by_y

    def mass_matrix(self) -> Floats:
        """[A] at the state."""
        full = np.zeros((self.model.nv, self.model.nv))
        self._mujoco.mj_fullM(self.model, self.data, full)
        a = np.empty_like(full)
        a[np.ix_(self.speeds, self.speeds)] = full
        return a

    def forces(self) -> tuple[Floats, ...]:
        """The forces whose sum is {f}: of inertia and gravity, of springs and dampers, of actuators."""
        data = self.data
        return tuple(map(self.of_speeds, (-data.qfrc_bias, data.qfrc_passive, data.qfrc_actuator)))

    def inputs(self) -> dict[str, float]:
        """The inputs of the actuators as parameters of the system."""
        model, data = self.model, self.data
        found = {}
        for i in range(model.nactuator):
            name = re.sub("[^A-Za-z0-9_]", "_", model.actuator(i).name or f"actuator{i}")
            found[f"ctrl_{name}"] = float(data.ctrl[model.actuator_ctrladr[i]])
            if model.actuator_actadr[i] >= 0:
                found[f"act_{name}"] = float(data.act[model.actuator_actadr[i]])
        return found

    def frame(self, name: str, is_site: bool) -> tuple[Floats, Floats]:
        """Rotation from a body or site to the world, and position of its origin."""
        data = self.data
        found = data.site(name) if is_site else data.body(name)
        rotation, position = found.xmat.reshape(3, 3), found.xpos
        return np.array(rotation), np.array(position)

    def of_speeds(self, values: Any) -> Floats:
        """Values at the degrees of freedom of MuJoCo, such as `data.qfrc_bias`, in the order of {y}."""
        found = np.empty(self.model.nv)
        found[self.speeds] = values
        return found


def _leave_out(mujoco: Any, model: Any) -> None:
    """Take out of a model of MuJoCo what kanegen leaves out."""
    off = mujoco.mjtDisableBit
    model.opt.disableflags |= int(off.mjDSBL_CONSTRAINT) | int(off.mjDSBL_CLAMPCTRL)
    model.opt.density = model.opt.viscosity = 0
    model.actuator_forcelimited[:] = model.jnt_actfrclimited[:] = model.actuator_actearly[:] = False
    model.actuator_delay[:] = 0
    joint_wrap = int(mujoco.mjtWrap.mjWRAP_JOINT)
    spatial = [i for i in range(model.ntendon) if model.wrap_type[model.tendon_adr[i]] != joint_wrap]
    model.tendon_stiffness[spatial] = model.tendon_damping[spatial] = 0
    model.tendon_armature[:] = 0
    for i in range(model.nactuator):
        in_space = (
            model.actuator_trntype[i] == int(mujoco.mjtTrn.mjTRN_TENDON)
            and model.actuator_trnid[i][0] in spatial
        )
        others = (mujoco.mjtTrn.mjTRN_BODY, mujoco.mjtTrn.mjTRN_SLIDERCRANK)
        is_muscle = model.actuator_gaintype[i] > 1 or model.actuator_biastype[i] > 1
        if in_space or is_muscle or model.actuator_trntype[i] in map(int, others):
            model.actuator_gaintype[i] = model.actuator_biastype[i] = 0
            model.actuator_gainprm[i] = 0


def _places(model: Any, system: System) -> tuple[list[int], list[int]]:
    """The place in {x} of each element of `qpos`, and in {y} of each of `qvel`."""
    coordinates, speeds = [], []
    for joint in range(model.njnt):
        kind = int(model.jnt_type[joint])
        body = model.body(model.jnt_bodyid[joint]).name or f"body{model.jnt_bodyid[joint]}"
        if kind >= 2:
            name = model.joint(joint).name or f"joint{joint}"
            coordinates.append(system.coordinate_names.index(name))
            speeds.append(system.speed_names.index(name))
            continue
        translations = [f"{body}.s{i}" for i in (1, 2, 3)] if kind == 0 else []
        quaternion = [f"{body}.e{i}" for i in range(4)]
        omega = [f"{body}.omega{i}" for i in (1, 2, 3)]
        coordinates += [system.coordinate_names.index(name) for name in translations + quaternion]
        speeds += [system.speed_names.index(name) for name in translations + omega]
    return coordinates, speeds


JOINTS = (
    (),
    ("hinge",),
    ("slide",),
    ("ball",),
    ("slide", "slide", "hinge"),
    ("slide", "slide", "slide", "ball"),
    ("hinge", "hinge"),
    ("hinge", "hinge", "hinge"),
    ("slide", "hinge", "hinge", "hinge"),
    ("hinge", "slide", "hinge"),
    ("hinge", "hinge", "hinge", "hinge", "slide", "slide"),
)
"""Types of the joints of one body."""

AXES = ("basis", "basis", "orthogonal", "any")
"""How the axes of the joints of a body lie: along basis vectors, orthogonal to each other, or anyhow."""


def random_model(seed: int, bodies: int = 5) -> str:
    """Return a random MJCF model: every type of joint, several to a body, with anchors and references."""
    rng = np.random.default_rng(seed)
    nested: list[list[str]] = [[] for _ in range(bodies + 1)]
    for k in range(bodies, 0, -1):
        lower = int(rng.integers(0, k))
        free = lower == 0 and rng.random() < 0.3
        nested[lower].insert(0, _body(rng, k, free, "".join(nested[k])))
    gravity = _text(rng.normal(size=3))
    return (
        f'<mujoco model="random {seed}"><compiler angle="radian"/><option gravity="{gravity}"/>'
        f"<worldbody>{''.join(nested[0])}</worldbody></mujoco>"
    )


def _body(rng: np.random.Generator, k: int, free: bool, inside: str) -> str:
    """Return the element of body `k` with the bodies on it."""
    types = JOINTS[int(rng.integers(len(JOINTS)))] if k > 1 else ("hinge", "hinge")
    joints = "<freejoint/>" if free else _joints(rng, k, types)
    place = f'pos="{_text(rng.normal(size=3))}"'
    if rng.random() < 0.6:
        place += f' quat="{_text(rng.normal(size=4))}"'
    moments = rng.uniform(0.5, 1.0, 3)
    return (
        f'<body name="b{k}" {place}>{joints}<inertial mass="{rng.uniform(0.5, 2)}" '
        f'pos="{_text(rng.normal(size=3))}" quat="{_text(rng.normal(size=4))}" '
        f'diaginertia="{_text(moments)}"/><site name="{"b" if k == 2 else "s"}{k}" pos="0.1 0.2 {k}" '
        f'quat="{_text(rng.normal(size=4))}"/>{inside}</body>'
    )


def _joints(rng: np.random.Generator, k: int, types: tuple[str, ...]) -> str:
    """Return the elements of the joints of body `k`."""
    lie = AXES[int(rng.integers(len(AXES)))]
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0] if lie == "orthogonal" else np.eye(3)
    anchor = rng.normal(size=3) * int(rng.integers(2))
    found = ""
    for i, kind in enumerate(types):
        axis = rng.normal(size=3) if lie == "any" else frame[int(rng.integers(3))] * rng.choice((-1, 1))
        here = rng.normal(size=3) if rng.random() < 0.1 else anchor
        turned = "" if kind == "ball" else f'axis="{_text(axis)}" ref="{rng.normal() * rng.integers(2)}"'
        found += (
            f'<joint name="j{k}{"abcdef"[i]}" type="{kind}" armature="0.1" pos="{_text(here)}" {turned}/>'
        )
    return found


def _text(values: Any) -> str:
    """Return numbers as an attribute holds them."""
    return " ".join(repr(float(value)) for value in values)


def model_file(folder: Path, text: str) -> Path:
    """Write a model file."""
    path = folder / "model.xml"
    path.write_text(text)
    return path


def errors(system: System, mujoco: MujocoModel, rng: np.random.Generator) -> tuple[float, float, float]:
    """Relative errors of [A], {f} and {ydot} beside MuJoCo, in a random state with random inputs.

    They are relative to the diagonal of [A], the largest force, and the largest acceleration.
    """
    x, y = mujoco.draw_state(rng)
    a, expected = mass_matrix(system, x), mujoco.mass_matrix()
    size = np.sqrt(np.outer(expected.diagonal(), expected.diagonal()))
    known = {parameter.name for parameter in system.parameters}
    at_inputs = system.with_parameters({k: v for k, v in mujoco.inputs().items() if k in known})
    f, terms = forcing(at_inputs, x, y), mujoco.forces()
    ydot = mujoco.of_speeds(mujoco.data.qacc_smooth)
    return (
        float(np.abs((a - expected) / size).max()),
        float(np.abs(f - sum(terms)).max() / max(np.abs(term).max() for term in terms)),
        float(np.abs(np.linalg.solve(a, f) - ydot).max() / np.abs(ydot).max()),
    )


def assert_same_values(path: Path, states: int = 2) -> None:
    """Compare [A], {f} and {ydot} of a file with MuJoCo's, where couplings do not hold."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".*names that are taken already", KanegenWarning)
        system = replace(kg.load(path), couplings=())
    mujoco, rng = MujocoModel(path, system), np.random.default_rng(7)
    for _ in range(states):
        of_a, of_f, of_ydot = errors(system, mujoco, rng)
        assert of_a < TOLERANCE and of_f < TOLERANCE and of_ydot < 10 * TOLERANCE
