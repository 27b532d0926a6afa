"""The artifact "reanchoring": a header that re-anchors joints at run time, away from their gimbal lock."""

from __future__ import annotations

from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.errors import quoted


def reanchoring(source: Source) -> dict[str, str]:
    """Return the text of the header `<model>_reanchor.h`, by its name."""
    model = source.model
    text = fill("artifacts/model_reanchor.h", model=model, prefix=model.prefix, joints=model.reanchorable)
    return {f"{model.name}_reanchor.h": text}


def refusal(source: Source) -> str:
    """Return why `source` cannot have the header, "" if it can."""
    if {source.precision, source.storage} != {"double"}:
        return (
            "re-anchoring in C is for arrays and arithmetic of double precision, not for "
            f"{source.precision} in arrays of {source.storage}. Leave out one or the other."
        )
    if not source.model.reanchorable:
        return (
            f"system {quoted(source.model.shown)} has nothing to re-anchor in C: no body has three free "
            "angles and three parameters of its own as the orientation of its joint. Give orientation_angles "
            "three parameters."
        )
    return ""
