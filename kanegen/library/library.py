"""The class of compiled models, and how one comes about."""

from __future__ import annotations

from collections.abc import Sequence

from kanegen.c import Source
from kanegen.library.derivatives import Derivatives
from kanegen.library.dynamics import Dynamics
from kanegen.library.native.build import build
from kanegen.library.native.calls import Native
from kanegen.library.points import Points
from kanegen.library.quantities import Quantities
from kanegen.library.reactions import Reactions


def load(
    source: Source,
    compiler: str | None = None,
    flags: str | Sequence[str] | None = None,
    threads: bool = False,
) -> Library:
    """Compile `source`, or find it in the cache, and load it.

    Args:
        source: From `kanegen.generate`.
        compiler: Command of a C compiler; by default the first that is found.
        flags: Its flags; by default optimised with IEEE semantics kept.
        threads: Let OpenMP share batches of 1024 states and more among threads, as many as `OMP_NUM_THREADS`
            says. No bit depends on it. A process that has used them must not fork. A compiler without OpenMP
            brings a `KanegenWarning`, and one thread.

    Raises:
        BuildError: If there is no compiler, it fails, or what it makes cannot be loaded.
    """
    return Library(Native(source, build(source, compiler, flags, threads)), dict(source.model.parameters))


class Library(Dynamics, Reactions, Quantities, Points, Derivatives):
    """The functions of a model, with values of its parameters.

    The coordinates of a state are an array of shape (m,), m being n where there are no quaternions, and its
    speeds one of shape (n,); many at once are (B, m) and (B, n), and every result then has B rows, also where
    B is 0. Contiguous arrays of its `storage` are passed to C as they are; lists, integers, other floats and
    other orders of memory are converted first. So a library in single precision rounds doubles; its results
    are arrays of float32. NaN and infinity pass through. A result does not depend on its place in a batch or
    on what else is there, and is that of the state alone: with strict semantics it is the same bits from
    every compiler at every level, since sine and cosine are kanegen's own unless the variant says otherwise.
    Objects are immutable and may be shared by threads; C runs without the interpreter's lock. They can be
    pickled: another process of the machine loads the same compiled file.
    """
