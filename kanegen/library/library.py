"""A compiled model: `load` makes a `Library` of generated C."""

from __future__ import annotations

from collections.abc import Sequence

from kanegen.c import Source
from kanegen.errors import OptionError
from kanegen.library.contacts import Contacts
from kanegen.library.derivatives import Derivatives
from kanegen.library.dynamics import Dynamics
from kanegen.library.equation_terms import EquationTerms
from kanegen.library.frames import Frames
from kanegen.library.identification import Identification
from kanegen.library.linearization import Linearization
from kanegen.library.native.build import Recipe
from kanegen.library.native.loaded import NativeLibrary
from kanegen.library.native.status import OnStatus, checked_on_status
from kanegen.library.operational import OperationalSpace
from kanegen.library.products import Products
from kanegen.library.quantities import Quantities
from kanegen.library.quantity_derivatives import QuantityDerivatives
from kanegen.library.right_side import RightSides
from kanegen.library.step_derivatives import StepDerivatives


def load(
    source: Source,
    compiler: str | None = None,
    flags: str | Sequence[str] | None = None,
    threads: bool = False,
    on_status: OnStatus = "warn",
) -> Library:
    """Compile `source`, or find it in the cache, and load it.

    Args:
        source: Generated C, from `kanegen.generate`.
        compiler: Command of a C compiler; by default the first that is found.
        flags: Compiler flags; by default those of the variant, which optimise and keep IEEE semantics.
        threads: Whether OpenMP shares batches of 1024 states and more among threads, as many as
            `OMP_NUM_THREADS` says. No bit of a result depends on it. In a process that was forked from one
            with threads, batches use one thread. With a compiler without OpenMP this gives a
            `KanegenWarning`, and batches use one thread.
        on_status: What the library does where a result is missing, not finite or not accurate, see
            `Library.with_on_status`: "warn", "raise", "ignore" or a function.

    Raises:
        BuildError: If there is no compiler, it fails, or the compiled library cannot be loaded.
        OptionError: If `source` has no functions for many states, which `Library` calls.

    Example:
        source = kg.generate(system)
        library = kanegen.library.load(source)
    """
    if not source.has_batches:
        raise OptionError(
            f"{source.model.name}: this code has no functions for many states, which a library calls. "
            "Generate it without batches=False."
        )
    recipe = Recipe.of(source, compiler, flags, threads)
    return Library(NativeLibrary.made(recipe), dict(source.model.parameters), checked_on_status(on_status))


class Library(
    Linearization,
    RightSides,
    Dynamics,
    EquationTerms,
    Contacts,
    Quantities,
    Frames,
    OperationalSpace,
    Identification,
    Derivatives,
    Products,
    QuantityDerivatives,
    StepDerivatives,
):
    """The functions of a compiled model, with values of its run-time parameters.

    A state has coordinates of shape (m,) and generalized speeds of shape (n,), n being the number of freedoms
    and m = n where there are no quaternions. B states at once are (B, m) and (B, n), and every result then
    has B rows, also if B is 0.

    Contiguous arrays of its `storage` are passed to C as they are; lists, integers, other floats and other
    memory layouts are converted first. A library in single precision therefore rounds doubles, and its
    results are arrays of float32. NaN and infinity pass through. What is missing, not finite or not accurate
    gives a warning or an error, by the one rule that `with_on_status` describes.

    A result does not depend on its place in a batch or on the other states, and is that of the state alone.
    With strict semantics it is the same to the last bit with every compiler at every level of optimisation,
    since sine and cosine are kanegen's own unless the variant says otherwise.

    Libraries are immutable and threads may share them; C runs without the interpreter's lock. They can be
    pickled: another process loads the same compiled file, or compiles the source, which the pickle carries,
    where that file is missing or damaged or the machine is another one.

    Example:
        system = kg.load("models/double_pendulum.toml")
        library = kg.build(system, outputs=("mass_matrix", "forward_dynamics"))
        x, y = [0.1, 0.2], [0.0, 1.0]
        A = library.mass_matrix(x)              # (2, 2)
        ydot = library.forward_dynamics(x, y)   # (2,)
        many = library.forward_dynamics(np.zeros((100, 2)), np.ones((100, 2)))   # (100, 2)
    """
