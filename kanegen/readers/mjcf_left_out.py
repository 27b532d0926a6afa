"""What an MJCF model has and the equations of a tree of rigid bodies have not, for one warning."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from kanegen.errors import counted, excerpt
from kanegen.readers.mjcf_compiled import Compiled

SHOWN = 6
"""Number of names of one kind that the warning shows."""

LONGEST_NAMES = 200
"""Number of characters of the names of one kind that the warning shows."""


@dataclass(frozen=True)
class LeftOut:
    """Something of several parts of a model that is left out.

    Attributes:
        what: What is left out, such as "contacts".
        noun: The parts, in the singular, such as "geom".
        names: Their names.
        reason: A clause that says more about them, or "".
        plural: The plural of the noun, "" if it has an s at its end.
    """

    what: str
    noun: str
    names: tuple[str, ...]
    reason: str = ""
    plural: str = ""

    def __str__(self) -> str:
        """Return a phrase with the number and the names of the parts."""
        count = counted(len(self.names), self.noun, self.plural)
        shown = ", ".join(self.names[:SHOWN]) + (", ..." if len(self.names) > SHOWN else "")
        reason = f", {self.reason}" if self.reason else ""
        return f"{self.what} of {count} ({excerpt(shown, LONGEST_NAMES)}){reason}"


def summary(parts: Iterable[LeftOut]) -> str:
    """Return what is left out in one line, "" if nothing is."""
    return "; ".join(str(part) for part in parts if part.names)


def left_out(model: Compiled) -> Iterator[LeftOut]:
    """Yield what no system of kanegen has.

    Force elements, actuators and couplings report themselves what they leave out.
    """
    compiled = model.model
    yield from _contacts(model)
    yield from _constraints(model)
    fluid = {"density": compiled.opt.density, "viscosity": compiled.opt.viscosity}
    present = tuple(name for name, value in fluid.items() if value)
    yield LeftOut("forces", "property of the fluid", present, plural="properties of the fluid")
    mocap = [body for body in range(int(compiled.nbody)) if compiled.body_mocapid[body] >= 0]
    reason = "which stay where the file has them"
    yield LeftOut("motions", "mocap body", model.names("body", mocap), reason, "mocap bodies")
    flexes = tuple(f"flex{number}" for number in range(int(compiled.nflex)))
    yield LeftOut("deformations", "flex", flexes, plural="flexes")
    yield LeftOut("effects", "plugin", tuple(f"plugin{number}" for number in range(int(compiled.nplugin))))


def _contacts(model: Compiled) -> Iterator[LeftOut]:
    """Yield the geoms that can touch others."""
    compiled = model.model
    if model.disables("CONTACT"):
        return
    geoms = {
        i for i in range(int(compiled.ngeom)) if compiled.geom_contype[i] or compiled.geom_conaffinity[i]
    }
    geoms |= {int(geom) for ends in (compiled.pair_geom1, compiled.pair_geom2) for geom in ends}
    yield LeftOut("contacts", "geom", model.names("geom", sorted(geoms)))


def _constraints(model: Compiled) -> Iterator[LeftOut]:
    """Yield limits of joints and tendons, and friction of tendons, which are constraints in MuJoCo."""
    compiled = model.model
    if not model.disables("LIMIT"):
        limited = [joint for joint in range(int(compiled.njnt)) if compiled.jnt_limited[joint]]
        reason = "whose ranges are kept as system.limits"
        yield LeftOut("forces at the limits", "joint", model.names("joint", limited), reason)
    tendons = range(int(compiled.ntendon))
    for what, values in (
        ("forces at the limits", compiled.tendon_limited),
        ("dry friction", compiled.tendon_frictionloss),
        ("armature", compiled.tendon_armature),
    ):
        yield LeftOut(what, "tendon", model.names("tendon", (i for i in tendons if values[i])))
