"""Whether a region keeps away from gimbal lock, as it must where the speeds are angle rates."""

from __future__ import annotations

import math

from kanegen.errors import OptionError
from kanegen.studies.budget.region import Region


def require_clear(region: Region) -> None:
    """Make sure that no state of a region stands at gimbal lock where that matters.

    Raises:
        OptionError: If one does; names what to exclude.
    """
    domain, system = region.domain, region.system
    if domain.clearance > 0:
        return
    for place, lock in domain.locking.items():
        body = system.bodies[system.coordinates[place].body - 1]
        if not body.joint.spins and _meets(lock, domain.low[place], domain.high[place]):
            name = system.coordinate_names[place]
            raise OptionError(
                f"domain: [A] is singular where {'cos' if lock else 'sin'}({name}) = 0, which x.{name} from "
                f"{domain.low[place]:.4g} to {domain.high[place]:.4g} meets. Exclude that, such as by "
                f"exclude.clearance = 0.05, or give the joint of {body.name!r} the speeds angular_velocity, "
                "which are regular there."
            )


def _meets(lock: float, low: float, high: float) -> bool:
    """Whether an angle between these ends can be `lock`, or half turns away from it."""
    return math.floor((high - lock) / math.pi) >= math.ceil((low - lock) / math.pi)
