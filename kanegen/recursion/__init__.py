"""The recursive form of the equations: identical values, far fewer operations than the literal one.

Composite bodies give [A]; an outward recursion of motions and an inward one of forces give {f}; articulated
bodies, or a factorisation of [A], give {ydot}. Every result is named at once, so no expression ever grows.
"""

from kanegen.recursion.derivation import Methods, RecursiveForm, derive, derive_correction_size, methods

__all__ = ["Methods", "RecursiveForm", "derive", "derive_correction_size", "methods"]
