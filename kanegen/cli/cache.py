"""`kanegen cache`: what is in the cache of compiled code, and how to empty it."""

from __future__ import annotations

import json
import time
from typing import Annotated

import typer

from kanegen.cli.options import AsJson
from kanegen.cli.terminal import print_plain, print_table

_MINUTE, _HOUR, _DAY = 60.0, 3600.0, 24 * 3600.0
"""Seconds of a minute, an hour and a day."""

_MEGABYTE = 1e6
"""Bytes of a megabyte."""

app = typer.Typer(
    no_args_is_help=True,
    help="List or clear the cache of compiled code.\n\n"
    "The cache is the folder $KANEGEN_CACHE, by default kanegen in your cache folder. It keeps compiled "
    "libraries and programs, so that each is compiled once. When it exceeds $KANEGEN_CACHE_MB megabytes, by "
    "default 1024, what was not used for the longest time is removed.",
)


@app.command("list")
def list_entries(as_json: AsJson = False) -> None:
    """List the libraries and programs in the cache, the one that was used last at the end."""
    from kanegen.library.native import cache, environment

    found = cache.entries()
    limit = environment.limit(environment.CACHE_MEGABYTES)
    now = time.time()
    if as_json:
        rows = [
            {"path": str(entry.path), "file": entry.name, "bytes": entry.size, "last_use": entry.last_use}
            for entry in found
        ]
        table = {"folder": str(cache.folder()), "limit_megabytes": limit, "entries": rows}
        typer.echo(json.dumps(table, indent=2))
        return
    if found:
        lines = [[entry.name, f"{entry.size / _MEGABYTE:.3f}", _age(now - entry.last_use)] for entry in found]
        print_table(["file", "MB", "last use"], lines)
    size = sum(entry.size for entry in found) / _MEGABYTE
    print_plain(f"{len(found)} entries, {size:.1f} MB of at most {limit:g} MB, in {cache.folder()}")


def _age(seconds: float) -> str:
    """Return a time since the last use in words; uses are noted to within ten minutes."""
    if seconds >= _DAY:
        return f"{seconds / _DAY:.1f} days ago"
    if seconds >= _HOUR:
        return f"{seconds / _HOUR:.1f} hours ago"
    return f"{max(seconds, 0.0) / _MINUTE:.0f} minutes ago"


@app.command("clear")
def clear(
    unused_for: Annotated[
        float,
        typer.Option(
            "--unused-for", metavar="DAYS", min=0.0, help="Keep what was used within the last DAYS days."
        ),
    ] = 0.0,
) -> None:
    """Remove the libraries and programs in the cache. Processes that have loaded one of them keep it."""
    from kanegen.library.native import cache

    removed = cache.clear(unused_for * _DAY)
    size = sum(entry.size for entry in removed) / _MEGABYTE
    print_plain(f"removed {len(removed)} entries, {size:.1f} MB, from {cache.folder()}")
