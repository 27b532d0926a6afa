"""kanegen: Kane's equations of motion for a tree of rigid bodies, as C specialised to that tree.

Every public name is imported from its module when it is first used, so that `import kanegen` alone loads
neither SymPy nor NumPy.

Example:
    import kanegen as kg

    system = kg.load("models/eight_body.toml")
    equations = kg.derive(system)      # SymPy
    source = kg.generate(system)       # C
    library = kg.build(system)         # compiled; NumPy in, NumPy out
    report = kg.compare(system)        # against an independent reference
"""

from __future__ import annotations

import importlib
import importlib.util
from typing import TYPE_CHECKING

__version__ = "0.1.0"
"""The version of kanegen, which the code that it generates also carries."""

if TYPE_CHECKING:
    from kanegen.browser.page import WebPage as WebPage
    from kanegen.browser.web import web as web
    from kanegen.c.source import Source as Source
    from kanegen.compiler import bound as bound
    from kanegen.compiler import build as build
    from kanegen.compiler import compare as compare
    from kanegen.compiler import derive as derive
    from kanegen.compiler import equilibria as equilibria
    from kanegen.compiler import generate as generate
    from kanegen.compiler import linearize as linearize
    from kanegen.errors import ArrayError as ArrayError
    from kanegen.errors import BudgetError as BudgetError
    from kanegen.errors import BuildError as BuildError
    from kanegen.errors import CertificateError as CertificateError
    from kanegen.errors import KanegenError as KanegenError
    from kanegen.errors import KanegenWarning as KanegenWarning
    from kanegen.errors import MissingError as MissingError
    from kanegen.errors import ModelError as ModelError
    from kanegen.errors import OptionError as OptionError
    from kanegen.errors import ReadError as ReadError
    from kanegen.errors import SingularError as SingularError
    from kanegen.errors import StatusError as StatusError
    from kanegen.errors import SweepError as SweepError
    from kanegen.errors import WriteError as WriteError
    from kanegen.library.library import Library as Library
    from kanegen.linear.linear_model import LinearModel as LinearModel
    from kanegen.measure.bounds.report import Bounds as Bounds
    from kanegen.measure.report import Report as Report
    from kanegen.model.body import Body as Body
    from kanegen.model.body import Point as Point
    from kanegen.model.contact import Contact as Contact
    from kanegen.model.coupling import Coupling as Coupling
    from kanegen.model.force_elements import Drive as Drive
    from kanegen.model.force_elements import Expression as Expression
    from kanegen.model.force_elements import ForceElement as ForceElement
    from kanegen.model.force_elements import JointFriction as JointFriction
    from kanegen.model.force_elements import JointSpring as JointSpring
    from kanegen.model.force_elements import PointLoad as PointLoad
    from kanegen.model.force_elements import Potential as Potential
    from kanegen.model.force_elements import Spring as Spring
    from kanegen.model.force_elements import parse as parse
    from kanegen.model.frame import Frame as Frame
    from kanegen.model.identification.base_parameters import BaseParameters as BaseParameters
    from kanegen.model.identification.base_parameters import base_parameters as base_parameters
    from kanegen.model.identification.inertial_parameters import inertial_parameters as inertial_parameters
    from kanegen.model.joint import Joint as Joint
    from kanegen.model.limits import Limits as Limits
    from kanegen.model.numbers import Parameter as Parameter
    from kanegen.model.reanchoring import reanchored as reanchored
    from kanegen.model.rotor import Rotor as Rotor
    from kanegen.model.system import System as System
    from kanegen.options import Variant as Variant
    from kanegen.products.exporting import export as export
    from kanegen.readers import load as load
    from kanegen.simulation.events import Event as Event
    from kanegen.simulation.simulate import simulate as simulate
    from kanegen.simulation.trajectory import Trajectory as Trajectory
    from kanegen.sweeps.job import RolloutJob as RolloutJob
    from kanegen.sweeps.results import SweepResult as SweepResult
    from kanegen.sweeps.sampling import Sampling as Sampling
    from kanegen.sweeps.sweep import open_sweep as open_sweep
    from kanegen.sweeps.sweep import sweep as sweep
    from kanegen.symbolic.equations import Equations as Equations
    from kanegen.viewer.view import View as View
    from kanegen.viewer.view import view as view

_MODULES = {
    "c.source": ("Source",),
    "browser.page": ("WebPage",),
    "browser.web": ("web",),
    "compiler": ("bound", "build", "compare", "derive", "equilibria", "generate", "linearize"),
    "errors": (
        "ArrayError",
        "BudgetError",
        "BuildError",
        "CertificateError",
        "KanegenError",
        "KanegenWarning",
        "MissingError",
        "ModelError",
        "OptionError",
        "ReadError",
        "SingularError",
        "StatusError",
        "SweepError",
        "WriteError",
    ),
    "library.library": ("Library",),
    "linear.linear_model": ("LinearModel",),
    "measure.bounds.report": ("Bounds",),
    "measure.report": ("Report",),
    "model.body": ("Body", "Point"),
    "model.contact": ("Contact",),
    "model.coupling": ("Coupling",),
    "model.force_elements": (
        "Drive",
        "Expression",
        "ForceElement",
        "JointFriction",
        "JointSpring",
        "PointLoad",
        "Potential",
        "Spring",
        "parse",
    ),
    "model.frame": ("Frame",),
    "model.identification.base_parameters": ("BaseParameters", "base_parameters"),
    "model.identification.inertial_parameters": ("inertial_parameters",),
    "model.joint": ("Joint",),
    "model.limits": ("Limits",),
    "model.numbers": ("Parameter",),
    "model.reanchoring": ("reanchored",),
    "model.rotor": ("Rotor",),
    "model.system": ("System",),
    "options": ("Variant",),
    "products.exporting": ("export",),
    "readers": ("load",),
    "simulation.events": ("Event",),
    "simulation.simulate": ("simulate",),
    "simulation.trajectory": ("Trajectory",),
    "sweeps.job": ("RolloutJob",),
    "sweeps.results": ("SweepResult",),
    "sweeps.sampling": ("Sampling",),
    "sweeps.sweep": ("open_sweep", "sweep"),
    "symbolic.equations": ("Equations",),
    "viewer.view": ("View", "view"),
}
"""Every public name by the module, below `kanegen`, that defines it."""

_DEFINED_IN = {name: module for module, names in _MODULES.items() for name in names}

__all__ = ["__version__", *_DEFINED_IN]  # noqa: PLE0604 - one table holds the names


def __getattr__(name: str) -> object:
    """Return the public name `name` from the module that defines it, or the package or module `name`."""
    if name not in _DEFINED_IN:
        if not name.startswith("_") and importlib.util.find_spec(f"kanegen.{name}") is not None:
            return importlib.import_module(f"kanegen.{name}")
        raise AttributeError(f"module 'kanegen' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"kanegen.{_DEFINED_IN[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return all public names, in alphabetical order."""
    return sorted(__all__)
