"""Force elements: loads that belong to a model, as springs, dampers, drives, loads on points and potentials.

Numbers in them may be parameters, and efforts may be expressions of coordinates, speeds and the time.
"""

from kanegen.model.expression import Expression
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.elements import (
    KINDS,
    Drive,
    JointFriction,
    JointSpring,
    PointLoad,
    Potential,
    Spring,
)
from kanegen.model.grammar import parse

__all__ = [
    "KINDS",
    "Drive",
    "Expression",
    "ForceElement",
    "JointFriction",
    "JointSpring",
    "PointLoad",
    "Potential",
    "Spring",
    "parse",
]
