"""The recursive form of the equations: the same values as the notes' equations, in far fewer operations.

One module holds one algorithm: composite bodies give [A] (`mass_matrix`); an outward recursion of motions and
an inward one of forces give {f} (`inverse_dynamics`); articulated bodies, or a factorisation of [A], give
{ydot} (`articulated_bodies`, `factorisation`, `refinement`); other modules give kinematics, energies and
reactions. Every intermediate gets a symbol at once, so that no expression grows. `outputs` is the table of
all outputs, and `derive` combines the recursions of several outputs.

Only derivations belong here, as functions of a `Tree` that return the entries of an output; instructions, C
code and numeric results do not. The notation is shared with `symbolic`, the mathematics is not.
"""

from kanegen.recursion.derivation import (
    Methods,
    RecursiveForm,
    derive,
    derive_losses,
    methods,
)

__all__ = ["Methods", "RecursiveForm", "derive", "derive_losses", "methods"]
