"""Compiled models: NumPy in, NumPy out.

`native` compiles generated C with the compiler of the machine, keeps the result in a cache and calls it;
`Library` has a typed method for each entry of the table of outputs. Code here runs or calls compiled
functions; the packages below decide what they compute, and `measure` checks their results.
"""

from kanegen.library.library import Library, load

__all__ = ["Library", "load"]
