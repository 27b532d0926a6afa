"""The page docs/closed-forms.md."""

from __future__ import annotations

from collections.abc import Sequence

import sympy

import kanegen as kg
from benchmarks.closed_forms.cases import MODELS
from benchmarks.closed_forms.measuring import Result
from kanegen.symbolic.printing import render

INTRODUCTION = """# Closed forms

`equations.closed_form()` and `kanegen equations MODEL` write [A] and {{f}} of a small tree without
intermediates, see [equations.md](equations.md#closed-forms). This page compares them with what SymPy's own
`KanesMethod` gives after `simplify`, and with the equations of textbooks. The values of all three agree in
random states. `python -m benchmarks.closed_forms` writes the page.

An operation is what SymPy's `count_ops` counts: every addition, subtraction, multiplication, division, power,
change of sign and call of a function; numbers cost nothing. [A] counts on and above its diagonal. Where a
textbook names a part, such as an inertia about a hinge, the part counts written out. Times are CPU times, the
smallest of {rounds} rounds in one process, each with an empty cache of SymPy {sympy}; those of kanegen
include the model file.

"""

HEAD = (
    "| system | kanegen, [A] + {f} | KanesMethod + simplify | textbook "
    "| kanegen (s) | KanesMethod + simplify (s) | ratio |",
    "| --- | ---: | ---: | ---: | ---: | ---: | ---: |",
)


def document(results: Sequence[Result], rounds: int) -> str:
    """Return the page for some results."""
    rows = [_row(result) for result in results]
    ours, theirs = sum(r.seconds for r in results), sum(r.kanes_seconds for r in results)
    total = f"| all | | | | {ours:.2f} | {theirs:.2f} | {theirs / ours:.0f} |"
    introduction = INTRODUCTION.format(rounds=rounds, sympy=sympy.__version__)
    return introduction + "\n".join([*HEAD, *rows, total, *_examples(), ""])


def _row(result: Result) -> str:
    """Return the line of one system."""
    path = "/".join(filter(None, ("../models", result.case.folder, f"{result.case.name}.toml")))
    counts = " | ".join(f"{a} + {f}" for a, f in (result.kanegen, result.kanes_method, result.textbook))
    agreement = "" if result.agrees else f" (differs by {result.difference:.1e})"
    return (
        f"| [{result.case.title}]({path}){agreement} | {counts} "
        f"| {result.seconds:.3f} | {result.kanes_seconds:.2f} | {result.kanes_seconds / result.seconds:.0f} |"
    )


def _examples() -> list[str]:
    """Return the closed forms of two models as they are printed."""
    parts = ["", "## What they look like", ""]
    for name in ("furuta_pendulum", "quarter_car"):
        printed = render(kg.derive(kg.load(MODELS / f"{name}.toml")))
        start = printed.index("Directions" if "Directions" in printed else "Mass matrix")
        parts += [
            f"`kanegen equations models/{name}.toml` ends with",
            "",
            "```text",
            printed[start:].strip(),
            "```",
            "",
        ]
    return parts[:-1]
