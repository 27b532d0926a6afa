"""Options of `generate` by which a budget chooses the variant, and which options go with them."""

from __future__ import annotations

from typing import Annotated

import typer

from kanegen.errors import OptionError

_PANEL = "With a budget"

ErrorBudget = Annotated[
    str | None,
    typer.Option("--error", metavar="NUMBER", help="Budget of the relative error.", rich_help_panel=_PANEL),
]
TimeBudget = Annotated[
    str | None,
    typer.Option("--budget", metavar="TIME", help="Such as 200ns or 1.5us.", rich_help_panel=_PANEL),
]
Domain = Annotated[
    str | None,
    typer.Option(
        "--domain",
        metavar="FILE.toml",
        help="States that count, or such as 'x.angles = [-1, 1]; y.angles = [-2, 2]'.",
        rich_help_panel=_PANEL,
    ),
]
Objective = Annotated[
    str,
    typer.Option("--objective", metavar="NAME", help="Timed: latency or batch.", rich_help_panel=_PANEL),
]
Quantile = Annotated[
    str,
    typer.Option(
        "--quantile",
        metavar="SHARE",
        help="Of the states that keep the error, such as 0.999; max: no state that is tried exceeds it.",
        rich_help_panel=_PANEL,
    ),
]
Confidence = Annotated[
    float, typer.Option("--confidence", help="With which that is shown.", rich_help_panel=_PANEL)
]
Attempts = Annotated[
    int,
    typer.Option("--attempts", help="Variants that may be validated at most.", rich_help_panel=_PANEL),
]
SelectStates = Annotated[
    int,
    typer.Option("--states", help="Random states to choose a variant by.", rich_help_panel=_PANEL),
]
Search = Annotated[
    int,
    typer.Option(
        "--search", help="States tried in each search for a counterexample.", rich_help_panel=_PANEL
    ),
]
Reproducible = Annotated[
    bool,
    typer.Option(
        "--reproducible",
        help="Only variants with the same bits on every machine.",
        rich_help_panel=_PANEL,
    ),
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Of all samples.", rich_help_panel=_PANEL)]

BUDGETS = ("error", "budget")
"""Options by which the variant is chosen."""

TERMS = (
    "domain",
    "objective",
    "quantile",
    "confidence",
    "attempts",
    "states",
    "search",
    "reproducible",
    "seed",
)
"""Options that say how."""

CHOICES = ("tier", "without", "storage", "sincos", "output", "function", "poses", "reactions", "reanchoring")
"""Options that would choose something themselves."""


def has_budget(context: typer.Context) -> bool:
    """Whether a budget chooses the variant.

    Raises:
        OptionError: If options contradict each other.
    """
    typed = {name for name in context.params if _is_typed(context, name)}
    chosen_by = [f"--{name}" for name in BUDGETS if name in typed]
    if len(chosen_by) > 1:
        raise OptionError("--error and --budget: give one of them. The other is what you get.")
    if not chosen_by:
        idle = [f"--{name}" for name in TERMS if name in typed]
        if idle:
            raise OptionError(f"{', '.join(idle)}: only with a budget. Add --error 1e-9 or --budget 200ns.")
        return False
    rivals = [f"--{name}" for name in CHOICES if name in typed]
    if rivals:
        raise OptionError(
            f"{', '.join(rivals)}: not with {chosen_by[0]}, which chooses the variant, for forward_dynamics. "
            "Leave one of them out; --precision and --reproducible limit the choice."
        )
    return True


def _is_typed(context: typer.Context, name: str) -> bool:
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"
