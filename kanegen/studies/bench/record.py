"""A contest as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict

from kanegen import __version__
from kanegen.measure import machine
from kanegen.studies.bench.outcome import BenchOptions, Outcome


def record(outcomes: Sequence[Outcome], terms: BenchOptions) -> str:
    """Every number, with the machine's description."""
    facts = {
        "kanegen": __version__,
        "machine": machine.description(),
        "terms": asdict(terms),
        "outcomes": [outcome.as_dict() for outcome in outcomes],
    }
    return json.dumps(facts, indent=2) + "\n"
