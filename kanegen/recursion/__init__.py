"""The recursive form of the equations: identical values, far fewer operations than the literal one.

Composite bodies give [A]; an outward recursion of motions and an inward one of forces give {f}. Every result
is named at once, so that no expression ever grows.
"""

from kanegen.recursion.form import RecursiveForm, recursive_form

__all__ = ["RecursiveForm", "recursive_form"]
