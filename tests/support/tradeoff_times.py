"""Stand-ins for the timing and the progress of a trade-off study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from kanegen.measure.timing import OBJECTIVES, Rounds, Times
from kanegen.studies.tradeoff.compilation import CompiledVariant


def ignore_stage(stage: str) -> None:
    """Ignore the name of a stage."""


def times_from_operations(
    samples: Mapping[CompiledVariant, Any], rounds: Rounds, progress: Any
) -> dict[CompiledVariant, dict[str, Times]]:
    """Return times that never vary: operations in ns, half of them for single precision."""
    del rounds, progress
    found = {}
    for one in samples:
        bytes_a_number = 1 if one.candidate.variant.precision == "float" else 2
        found[one] = dict.fromkeys(OBJECTIVES, Times((one.operations * bytes_a_number / 2,)))
    return found
