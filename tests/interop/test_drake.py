"""The lines of docs/conventions.md on Drake, held against it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pydrake.multibody.plant as drake
import pytest
from pydrake.multibody import parsing, tree

from kanegen.model.arrays import Floats
from tests.support.conventions import robot, write_urdf

NAMES = ("base", "arm", "tool")


class InDrake:
    """The robot and its state in Drake.

    Attributes:
        jacobian: (nv, n) the matrix [J] of v = [J]{y}.
        drift: (nv,) the product [Jdot]{y}.
    """

    def __init__(self, folder: Path) -> None:
        self.plant = drake.MultibodyPlant(0.0)
        parsing.Parser(self.plant).AddModels(str(write_urdf(folder)))
        self.plant.Finalize()
        self.context = self.plant.CreateDefaultContext()
        mine, system = robot(), robot().system
        x = dict(zip(system.coordinate_names, mine.x, strict=True))
        rotation: Floats = mine.results["body_poses"][0, :3]
        quaternion = [x[f"base.e{i}"] for i in range(4)]
        position = [x[f"base.s{i}"] for i in (1, 2, 3)]
        self.q = np.array([*quaternion, *position, x["shoulder"], x["slide"]])
        self.jacobian = np.zeros((8, 8))
        place = system.speed_names.index
        for i in range(3):
            self.jacobian[:3, place(f"base.omega{i + 1}")] = rotation.T[:, i]  # into world components
            self.jacobian[3 + i, place(f"base.s{i + 1}")] = 1.0
        self.jacobian[6, place("shoulder")] = self.jacobian[7, place("slide")] = 1.0
        self.v, self.vdot = self.jacobian @ mine.y, self.jacobian @ mine.ydot
        self.plant.SetPositions(self.context, self.q)
        self.plant.SetVelocities(self.context, self.v)
        self.bodies = [self.plant.GetBodyByName(name) for name in NAMES]


@pytest.fixture
def found(tmp_path: Path) -> InDrake:
    return InDrake(tmp_path)


def _close(found: Any, expected: Any) -> None:
    """Make sure that two results agree to 1e-13 of the largest entry: roundings of three bodies."""
    assert np.shape(found) == np.shape(expected)
    assert np.abs(np.asarray(found) - expected).max() <= 1e-13 * max(np.abs(expected).max(), 1e-3)


def test_a_floating_base_has_its_quaternion_first_scalar_first(found: InDrake) -> None:
    names = found.plant.GetPositionNames()
    assert [name.rsplit("_", 1)[-1] for name in names[:7]] == ["qw", "qx", "qy", "qz", "x", "y", "z"]
    assert [name.rsplit("_", 1)[0].split("_")[-1] for name in names[7:]] == ["shoulder", "slide"]
    assert [name.rsplit("_", 1)[-1] for name in found.plant.GetVelocityNames()[:6]] == [
        "wx",
        "wy",
        "wz",
        "vx",
        "vy",
        "vz",
    ]


def test_velocities_are_angular_first_in_world_components(found: InDrake) -> None:
    for k, body in enumerate(found.bodies):
        velocity = found.plant.EvalBodySpatialVelocityInWorld(found.context, body)
        both = np.concatenate([velocity.rotational(), velocity.translational()])
        _close(both, robot().results["frame_velocities"][k])
    _close(found.v[:6], robot().results["frame_velocities"][0])


def test_rotations_take_body_to_world(found: InDrake) -> None:
    for k, body in enumerate(found.bodies):
        pose = found.plant.EvalBodyPoseInWorld(found.context, body)
        _close(pose.rotation().matrix().T, robot().results["body_poses"][k, :3])
        _close(pose.translation(), robot().results["body_poses"][k, 3])


def test_jacobians_have_angular_rows_first(found: InDrake) -> None:
    world = found.plant.world_frame()
    for k, body in enumerate(found.bodies):
        jacobian = found.plant.CalcJacobianSpatialVelocity(
            found.context, tree.JacobianWrtVariable.kV, body.body_frame(), np.zeros(3), world, world
        )
        _close(jacobian @ found.jacobian, robot().results["frame_jacobians"][k])


def test_mass_matrix_and_forcing(found: InDrake) -> None:
    """M vdot + C v = tau_gravity + tau, so {f} is [J]^T (tau_gravity - C v - M [Jdot]{y}); [Jdot]{y} is zero.

    The rate of [R_K]^T times {omega'} is the cross product of the angular velocity with itself.
    """
    mine, plant, context = robot(), found.plant, found.context
    m = plant.CalcMassMatrix(context)
    _close(found.jacobian.T @ m @ found.jacobian, mine.results["mass_matrix"])
    force = plant.CalcGravityGeneralizedForces(context) - plant.CalcBiasTerm(context)
    _close(found.jacobian.T @ force, mine.results["forcing"])


def test_inverse_dynamics_has_gravity_among_its_forces(found: InDrake) -> None:
    forces = tree.MultibodyForces_[float](found.plant)
    found.plant.CalcForceElementsContribution(found.context, forces)
    tau = found.plant.CalcInverseDynamics(found.context, found.vdot, forces)
    _close(found.jacobian.T @ tau, robot().results["inverse_dynamics"])


def test_energies_and_gravity(found: InDrake) -> None:
    results = robot().results
    energies = found.plant.CalcKineticEnergy(found.context), found.plant.CalcPotentialEnergy(found.context)
    _close(energies, np.array([results["kinetic_energy"], results["potential_energy"]]))
    assert tuple(found.plant.gravity_field().gravity_vector()) == robot().system.gravity


def test_momentum_about_the_mass_centre_is_angular_first(found: InDrake) -> None:
    plant, context, results = found.plant, found.context, robot().results
    center = plant.CalcCenterOfMassPositionInWorld(context)
    _close(center, results["mass_center"])
    momentum = plant.CalcSpatialMomentumInWorldAboutPoint(context, center)
    _close(np.concatenate([momentum.translational(), momentum.rotational()]), results["momentum"])


def test_inertias_are_about_the_origin_of_the_body(found: InDrake) -> None:
    for body, mine in zip(found.bodies, robot().system.bodies, strict=True):
        theirs = body.CalcSpatialInertiaInBodyFrame(found.context)
        mass, center = float(theirs.get_mass()), np.asarray(theirs.get_com())
        shift = mass * (center @ center * np.eye(3) - np.outer(center, center))
        about_origin = mass * theirs.get_unit_inertia().CopyToFullMatrix3()
        _close(about_origin - shift, np.asarray(mine.inertia, dtype=float))
