"""A small system whose forces are one expression."""

from __future__ import annotations

import kanegen as kg


def slide(effort: str | None = None, energy: str | None = None) -> kg.System:
    """Return masses of 2 kg on slides `q` and `p` along axes 1 and 2, without gravity, with one element."""
    nothing = ((0.0,) * 3,) * 3
    joints = [
        kg.Joint(name=name, free=tuple(k == axis for k in range(6))) for name, axis in (("q", 3), ("p", 4))
    ]
    bodies = tuple(kg.Body(f"b{k}", 0, 2.0, nothing, joint=joint) for k, joint in enumerate(joints))
    element = kg.Potential(kg.parse(energy)) if energy else kg.Drive("q", kg.parse(effort))
    return kg.System("slide", bodies, (0.0, 0.0, 0.0)).with_force_elements(element)
