"""A tree of rigid bodies: the source language of kanegen.

Body K (numbered from 1) hangs on its lower body J = L(K) < K, 0 being the ground. Its free coordinates make
up {x}; the locked ones leave {x}, {y}, [A] and {f}, and so do the prescribed ones, whose motion is an input.
"""

from kanegen.system.description import GRAVITY
from kanegen.system.freedoms import Coordinate, Freedom
from kanegen.system.system import System

__all__ = ["GRAVITY", "Coordinate", "Freedom", "System"]
