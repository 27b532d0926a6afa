"""Options of `kanegen generate` by which a budget chooses the variant, and the options that exclude them."""

from __future__ import annotations

from typing import Annotated

import typer

from kanegen.errors import OptionError

_PANEL = "With a budget"
"""Title of the group of these options in the help."""

ErrorBudget = Annotated[
    str | None,
    typer.Option(
        "--error", metavar="NUMBER", help="Largest relative error of {ydot} allowed.", rich_help_panel=_PANEL
    ),
]
TimeBudget = Annotated[
    str | None,
    typer.Option(
        "--budget",
        metavar="TIME",
        help="Longest time of one evaluation allowed, such as 200ns or 1.5us.",
        rich_help_panel=_PANEL,
    ),
]
Domain = Annotated[
    str | None,
    typer.Option(
        "--domain",
        metavar="FILE.toml",
        help="Domain of states, a file or a text such as 'x.angles = [-1, 1]; y.angles = [-2, 2]'.",
        rich_help_panel=_PANEL,
    ),
]
Objective = Annotated[
    str,
    typer.Option(
        "--objective",
        metavar="NAME",
        help="Time that is minimised: that of one call (latency) or of a state of a batch (batch).",
        rich_help_panel=_PANEL,
    ),
]
RelativeTo = Annotated[
    str,
    typer.Option(
        "--relative-to",
        metavar="NAME",
        help="Yardstick of the error: the accelerations that loads, gravity, speeds and tau each cause "
        "(terms), their sum {ydot} (solution), which vanishes in equilibrium, or rad/s^2 and m/s^2 (units).",
        rich_help_panel=_PANEL,
    ),
]
Quantile = Annotated[
    str,
    typer.Option(
        "--quantile",
        metavar="SHARE",
        help="Share of the states that must keep the error, such as 0.999, or max for every state tried.",
        rich_help_panel=_PANEL,
    ),
]
Confidence = Annotated[
    float,
    typer.Option(
        "--confidence",
        help="Confidence with which the share of states is shown by sampling.",
        rich_help_panel=_PANEL,
    ),
]
Attempts = Annotated[
    int,
    typer.Option("--attempts", help="Largest number of variants that are validated.", rich_help_panel=_PANEL),
]
SelectStates = Annotated[
    int,
    typer.Option("--states", help="Number of random states that rank the variants.", rich_help_panel=_PANEL),
]
Search = Annotated[
    int,
    typer.Option(
        "--search", help="Number of states tried in each search for counterexamples.", rich_help_panel=_PANEL
    ),
]
Reproducible = Annotated[
    bool,
    typer.Option(
        "--reproducible",
        help="Allow only variants that compute the same bits on every machine.",
        rich_help_panel=_PANEL,
    ),
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of all samples.", rich_help_panel=_PANEL)]

BUDGETS = ("error", "budget")
"""Names of the options that set a budget."""

BUDGET_OPTIONS = (
    "domain",
    "objective",
    "relative_to",
    "quantile",
    "confidence",
    "attempts",
    "states",
    "search",
    "reproducible",
    "seed",
)
"""Names of the options that are allowed only with a budget."""

EXCLUDED = (
    "tier",
    "without",
    "storage",
    "sincos",
    "machine",
    "output",
    "frames",
    "reactions",
    "contacts",
    "reanchoring",
    "mass_matrix",
    "for_",
)
"""Names of the options that a budget excludes, because the budget makes these choices."""


def has_budget(context: typer.Context) -> bool:
    """Return whether a budget chooses the variant.

    Raises:
        OptionError: If the options that were typed contradict each other.
    """
    typed = {name for name in context.params if is_typed(context, name)}
    budgets = [f"--{name}" for name in BUDGETS if name in typed]
    if len(budgets) > 1:
        raise OptionError("--error and --budget: give one of them. The search minimises the other.")
    if not budgets:
        idle = [f"--{name.replace('_', '-')}" for name in BUDGET_OPTIONS if name in typed]
        if idle:
            raise OptionError(f"{', '.join(idle)}: only with a budget. Add --error 1e-9 or --budget 200ns.")
        return False
    rivals = [f"--{name.rstrip('_').replace('_', '-')}" for name in EXCLUDED if name in typed]
    if rivals:
        raise OptionError(
            f"{', '.join(rivals)}: not with {budgets[0]}, which chooses the variant, for forward_dynamics. "
            "Leave one of them out; --precision and --reproducible limit the choice."
        )
    return True


def is_typed(context: typer.Context, name: str) -> bool:
    """Return whether an option was typed on the command line."""
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"
