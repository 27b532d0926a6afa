"""Prints what EXUDYN finds for the stiff flyball governor; EXUDYN is no dependency: pip install exudyn.

python -m benchmarks.validation.exudyn_governor

The kinematic tree is that of its example `stiffFlyballGovernorKT.py`: a hinge about z, a slide along z, and
two hinges about y. Results of the trapezoidal rule for steps that are halved are extrapolated to step 0:
their errors have even powers of the step (Gragg 1965), so that every extrapolation gains two orders.
"""

from __future__ import annotations

import math
from typing import Any

import exudyn
import exudyn.itemInterface as items
import numpy as np
from exudyn import utilities

TIMES = (0.1, 1.0, 10.0)
"""Times of the results, s."""

STEPS = (5e-4, 2.5e-4, 1.25e-4, 6.25e-5)
"""Steps of the trapezoidal rule, s."""

HEIGHT = 0.5
"""Height of the slider where its coordinate is zero, m."""


def main() -> None:
    for time in TIMES:
        last, best = _extrapolated(np.array([_last_state(time, step) for step in STEPS]))
        for name, place, offset in (
            ("height of the slider", 1, HEIGHT),
            ("angular velocity of the shaft", 4, 0.0),
        ):
            change = abs(best[place] - last[place])
            print(f"{name} at {time:g} s: {offset + best[place]:.14f}, last change {change:.0e}")


def _extrapolated(states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the last two extrapolations of states for steps that are halved."""
    factor, last = 4.0, states
    while len(states) > 1:
        last, states = states, (factor * states[1:] - states[:-1]) / (factor - 1)
        factor *= 4
    return last[-1], states[-1]


def _last_state(time: float, step: float) -> np.ndarray:
    """Return the four coordinates and the four rates at a time: shaft, slider, rods."""
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    node = system.AddNode(
        items.NodeGenericODE2(
            referenceCoordinates=[0.0] * 4,
            initialCoordinates=[0.0] * 4,
            initialCoordinates_t=[2 * math.pi, 0.0, 0.0, 0.0],
            numberOfODE2Coordinates=4,
        )
    )
    tree = system.AddObject(items.ObjectKinematicTree(nodeNumber=node, **_tree()))

    def marker(link: int, position: list[float]) -> Any:
        return system.AddMarker(
            items.MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=link, localPosition=position)
        )

    for rod, side in ((2, 0.05), (3, -0.05)):
        ends = [marker(1, [side, 0, 0]), marker(rod, [0.5, 0, 0])]
        system.AddObject(
            items.SpringDamper(markerNumbers=ends, stiffness=8e5, damping=4e4, referenceLength=0.5)
        )
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(time / step)
    settings.timeIntegration.endTime = time
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = True
    settings.timeIntegration.newton.relativeTolerance = 1e-12
    settings.timeIntegration.newton.absoluteTolerance = 1e-12
    settings.solutionSettings.writeSolutionToFile = False
    system.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.TrapezoidalIndex2)
    kinds = exudyn.OutputVariableType
    return np.concatenate(
        [system.GetNodeOutput(node, kind) for kind in (kinds.Coordinates, kinds.Coordinates_t)]
    )


def _tree() -> dict[str, Any]:
    """Return the arguments of the kinematic tree: shaft, slider and two rods with 5 kg at their ends."""
    beam, thickness, density = 1.0, 0.01, 3000.0
    rod = utilities.InertiaCuboid(density=density, sideLengths=[beam, thickness, thickness])
    rod = rod.Translated([beam / 2, 0, 0]) + utilities.InertiaMassPoint(mass=5).Translated([beam, 0, 0])
    inertias = [
        utilities.InertiaCuboid(density=density, sideLengths=[thickness, thickness, beam]),
        utilities.InertiaCuboid(density=density, sideLengths=[0.1, 0.1, 0.1]),
        rod,
        rod,
    ]
    offsets, centers = exudyn.Vector3DList(), exudyn.Vector3DList()
    turned, moments = exudyn.Matrix3DList(), exudyn.Matrix3DList()
    angles = (0.0, 0.0, math.radians(30), math.radians(150))
    positions = ([0, 0, 0.5], [0, 0, 0], [0.05, 0, 0.5], [-0.05, 0, 0.5])
    for inertia, angle, position in zip(inertias, angles, positions, strict=True):
        centers.Append(inertia.COM())
        moments.Append(inertia.InertiaCOM())
        turned.Append(utilities.RotationMatrixY(angle))
        offsets.Append(position)
    kinds = exudyn.JointType
    return {
        "jointTypes": [kinds.RevoluteZ, kinds.PrismaticZ, kinds.RevoluteY, kinds.RevoluteY],
        "linkParents": [-1, 0, 0, 0],
        "jointTransformations": turned,
        "jointOffsets": offsets,
        "linkInertiasCOM": moments,
        "linkCOMs": centers,
        "linkMasses": [inertia.Mass() for inertia in inertias],
        "baseOffset": [0.0, 0.0, 0.0],
        "gravity": [0.0, 0.0, -9.81],
    }


if __name__ == "__main__":
    main()
