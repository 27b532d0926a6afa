"""The recursive form of the equations: the values of the notes' equations by far fewer operations.

One module holds one algorithm: composite bodies give [A] (`mass_matrix`); an outward recursion of motions and
an inward one of forces give {f} (`inverse_dynamics`); articulated bodies, or a factorisation of [A], give
{ydot} (`articulated_bodies`, `factorisation`, `refinement`); and others give kinematics, energies and
reactions. Every intermediate is named at once, so that no expression ever grows. `outputs` is the table of
all that can be asked for, and `derive` combines the recursions of several outputs.

Only derivations enter here, as functions of a `Tree` that return the entries of an output; instructions, C
and numeric results do not. Notation is shared with `symbolic`, mathematics is not.
"""

from kanegen.recursion.derivation import Methods, RecursiveForm, derive, derive_correction_size, methods

__all__ = ["Methods", "RecursiveForm", "derive", "derive_correction_size", "methods"]
