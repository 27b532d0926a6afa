"""A header that moves joints away from the singularity of their angles, at run time, in C."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from kanegen.c.source import Source
from kanegen.c.stamp import stamped
from kanegen.c.templates import fill
from kanegen.errors import OptionError


@dataclass(frozen=True)
class Anchor:
    """A joint whose constant orientation is three parameters, and nothing else holds its frame.

    Attributes:
        body: Number of the body, from 1.
        name: Its name.
        parameters: Places of the orientation's angles in the array of parameters.
        angles: Places of the joint's angles in {x}.
        speeds: Those of their speeds in {y}.
        slides: Places of its translations in {x}; none if they are locked at zero.
        sliding: Those of their rates in {y}.
        axes: Basis vectors about which its angles turn, from 0.
        spins: Whether the speeds of its angles are components of the angular velocity.
    """

    body: int
    name: str
    parameters: tuple[int, int, int]
    angles: tuple[int, ...]
    speeds: tuple[int, ...]
    slides: tuple[int, ...]
    sliding: tuple[int, ...]
    axes: tuple[int, int, int]
    spins: bool

    @property
    def ends_alike(self) -> bool:
        """Whether the last angle turns about the axis of the first."""
        return self.axes[0] == self.axes[2]

    @property
    def row(self) -> str:
        """The same as an initialiser in C."""
        places = (self.parameters, self.angles, self.speeds, self.slides, self.sliding, self.axes)
        words = [f"{{{', '.join(map(str, triple or (-1, -1, -1)))}}}" for triple in places]
        return f"{{{', '.join([*words, str(int(self.spins))])}}}"


def with_anchors(source: Source, anchors: Sequence[Anchor]) -> Source:
    """The files of `source` with the header `<model>_reanchor.h`.

    Raises:
        OptionError: If the arrays of `source` are not of doubles.
    """
    model = source.model
    if {source.precision, source.storage} != {"double"}:
        raise OptionError(
            "re-anchoring in C is for arrays and arithmetic of double precision, not for "
            f"{source.precision} in arrays of {source.storage}. Leave out one or the other."
        )
    name = f"{model.name}_reanchor.h"
    text = fill("model_reanchor.h", model=model, prefix=model.name.upper(), anchors=anchors)
    return replace(source, files={**source.files, name: stamped(name, text)})
