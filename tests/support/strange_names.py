"""A system whose names are none of the identifiers of other languages."""

import kanegen as kg

INERTIA = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
TURN, MOVE = (False, False, True, False, False, False), (False, False, False, True, False, False)


def strange():
    """A system whose names are keywords, macros, equal in their letters, and of other scripts."""
    mass = kg.Parameter("I", 2.0)
    limits = kg.Limits.of({"theta3": {"position": (-1.5, 1.5), "effort": 87.0}})
    bodies = (
        kg.Body("左腿", 0, mass, INERTIA, joint=kg.Joint(free=TURN, name="for", limits=limits), loads=True),
        kg.Body("a b", 1, 1.0, INERTIA, joint=kg.Joint(free=TURN, name='a*/"b\\')),
        kg.Body("a_b", 2, 1.0, INERTIA, joint=kg.Joint(free=MOVE, name="errno")),
    )
    return kg.System("class", bodies).with_points({"右": ("左腿", (0, 0, 0)), "2": ("a_b", (1, 0, 0))})
