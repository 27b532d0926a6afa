"""A header that moves joints away from the singularity of their angles, at run time, in C."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from kanegen.c.provenance import stamped
from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.errors import OptionError
from kanegen.model.reanchorable import Anchor


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
