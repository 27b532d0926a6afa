"""A compiled model: NumPy in, NumPy out."""

from kanegen.library.library import Library, load

__all__ = ["Library", "load"]
