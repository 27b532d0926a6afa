"""Compiled models: NumPy in, NumPy out.

`native` compiles generated C with the compiler of the machine, keeps the result in a cache and calls it;
`Library` has a typed method for each entry of the table of outputs; `simulation` integrates a library over
time. What enters here runs or calls compiled code; what the code computes is decided below, and whether it is
right is measured above.
"""

from kanegen.library.library import Library, load

__all__ = ["Library", "load"]
