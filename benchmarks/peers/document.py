"""All of docs/benchmarks.md."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from string import Template

from benchmarks.peers import machine
from benchmarks.peers.building import EXACT, NATIVE, RELAXED, SETTINGS
from benchmarks.peers.report import Outcome, summary, table
from benchmarks.peers.results import TOLERANCE

_INTRODUCTION = """\
Written by `make bench` (`python -m benchmarks.peers`); nobody edits it by hand. A ratio is the time of
kanegen over that of the peer: 1/8 is an eighth of its time."""

_SHARED = """\
The machine was shared with other work while the times were taken. The contestants took turns, so ratios carry
over; nanoseconds are those of this machine under that load."""

_METHOD = Path(__file__).with_name("method.md")


def document(outcomes: Sequence[Outcome], states: int, rounds: int, seconds: float) -> str:
    """Markdown with summaries first, then how it was done, then every number."""
    parts = [
        "# kanegen beside its peers",
        _INTRODUCTION,
        "![Times as a share of Pinocchio's](benchmarks.svg)",
        f"## One state, compiler setting *{NATIVE.name}*",
        summary(outcomes, NATIVE),
        f"## Many states at once, compiler setting *{NATIVE.name}*",
        summary(outcomes, NATIVE, batch=True),
        f"## The default, *{EXACT.name}*",
        summary(outcomes, EXACT),
        f"## Compiler setting *{RELAXED.name}*",
        summary(outcomes, RELAXED),
        summary(outcomes, RELAXED, batch=True),
        "## What is compared",
        _method(states, rounds, seconds),
        "Settings of the compiler:",
        "\n".join(f"- *{setting.name}*: `{' '.join(setting.flags)}`" for setting in SETTINGS),
        "## Machine",
        "\n".join(f"- {line}" for line in machine.description()),
        _SHARED,
        "## Every number",
        *(table(outcome).strip() for outcome in outcomes),
    ]
    return "\n\n".join(parts) + "\n"


def _method(states: int, rounds: int, seconds: float) -> str:
    template = Template(_METHOD.read_text(encoding="utf-8"))
    numbers = {"states": states, "rounds": rounds, "seconds": seconds, "tolerance": f"{TOLERANCE:.0e}"}
    return template.substitute(numbers).strip()
