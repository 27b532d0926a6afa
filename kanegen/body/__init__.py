"""A rigid body and the joint by which it hangs on its lower body J.

Seen from J, the point Q_K stands at `position`; there the joint frame has the constant orientation [C_K]; in
it the origin O_K is displaced by s'_K; and body K is turned by three body-fixed angles, by default in the
sequence 1-2-3 of the notes, so that [^J R_K] = [R_123] [C_K]. Any of the six freedoms can be locked at a
value, or prescribed: the body then moves by it as it is told. Where all three angles are free, a quaternion
can take their place.
"""

from kanegen.body.body import Body
from kanegen.body.freedoms import FREEDOMS, ORIENTATIONS, QUATERNION, SPEEDS, named
from kanegen.body.joint import IDENTITY, Joint
from kanegen.body.point import Point

__all__ = [
    "FREEDOMS",
    "IDENTITY",
    "ORIENTATIONS",
    "QUATERNION",
    "SPEEDS",
    "Body",
    "Joint",
    "Point",
    "named",
]
