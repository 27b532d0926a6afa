"""kanegen: Kane's equations of motion for a tree of rigid bodies, as C specialised to that tree.

Example:
    import kanegen as kg

    system = kg.load("models/eight_body.toml")
    equations = kg.derive(system)      # SymPy
    source = kg.generate(system)       # C
    library = kg.build(system)         # compiled; NumPy in, NumPy out
    report = kg.compare(system)        # against an independent reference
"""

from kanegen.body import Body, Joint, Point
from kanegen.c import Source
from kanegen.check.report import Report
from kanegen.compiler import build, compare, derive, generate
from kanegen.errors import (
    ArrayError,
    BuildError,
    KanegenError,
    KanegenWarning,
    ModelError,
    OptionError,
    ReadError,
    SingularError,
    WriteError,
)
from kanegen.force_elements import (
    Drive,
    Expression,
    ForceElement,
    JointSpring,
    PointLoad,
    Potential,
    Spring,
    parse,
)
from kanegen.library import Library
from kanegen.numbers import Parameter
from kanegen.readers import load
from kanegen.reanchoring import reanchored
from kanegen.symbolic import Equations
from kanegen.system import System
from kanegen.variant import Variant
from kanegen.version import __version__

__all__ = [
    "ArrayError",
    "Body",
    "BuildError",
    "Drive",
    "Equations",
    "Expression",
    "ForceElement",
    "Joint",
    "JointSpring",
    "KanegenError",
    "KanegenWarning",
    "Library",
    "ModelError",
    "OptionError",
    "Parameter",
    "Point",
    "PointLoad",
    "Potential",
    "ReadError",
    "Report",
    "SingularError",
    "Source",
    "Spring",
    "System",
    "Variant",
    "WriteError",
    "__version__",
    "build",
    "compare",
    "derive",
    "generate",
    "load",
    "parse",
    "reanchored",
]
