"""A trajectory in a notebook: its caption, events, and columns at a few times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kanegen.errors import counted
from kanegen.model.arguments import Floats
from kanegen.pictures.html import python, sentence, shown, table
from kanegen.simulation.events import Occurrence

MOST_TIMES, MOST_COLUMNS, MOST_EVENTS = 7, 8, 8
"""Numbers of times, columns and events that are shown."""


def trajectory_html(
    name: str,
    caption: str,
    times: Floats,
    columns: Mapping[str, Floats],
    units: Mapping[str, str],
    events: Sequence[Occurrence],
) -> str:
    """Return the HTML of a trajectory for a notebook; of several states at once, the first.

    Args:
        name: Name of the model.
        caption: What is known about the whole motion.
        times: (T,) times, s.
        columns: Columns by name, (T,) or (T, B).
        units: Unit of each column.
        events: Events of the motion.
    """
    count, chosen = len(times), list(columns)[:MOST_COLUMNS]
    rows = sorted({round(k * (count - 1) / (MOST_TIMES - 1)) for k in range(MOST_TIMES)})
    several = [times, *(columns[one].reshape(count, -1)[:, 0] for one in chosen)]
    values = [[f"{float(column[k]) + 0.0:.6g}" for column in several] for k in rows]
    span = f"{counted(count, 'time')} from {times[0]:g} to {times[-1]:g} s"
    batch = [f"; the first of {counted(v.shape[1], 'state')}" for v in columns.values() if v.ndim > 1][:1]
    further = len(columns) - len(chosen)
    happened = [(f"{one.time:.10g}", one.condition) for one in events]
    return shown(
        sentence("{}; {}{}", caption, span, "".join(batch), strong=name),
        table(["t in s", *(f"{one} in {units[one]}" for one in chosen)], values),
        *([sentence("… {} more columns: {}", further, python("motion.to_pandas()"))] if further else ()),
        *(
            [table(("event at t in s", "condition"), happened, "motion.events", MOST_EVENTS)]
            if events
            else ()
        ),
    )
