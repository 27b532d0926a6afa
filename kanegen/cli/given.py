"""Which options of `generate` were typed, and which of them go together."""

from __future__ import annotations

import typer

from kanegen.errors import OptionError

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

CHOICES = ("tier", "without", "storage", "sincos", "output", "poses", "reactions", "reanchoring")
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
