"""The command line: a module for each command, under its name, and `app` for all of them together.

`options` and `budget_options` say what may be typed and `loading` makes the system of it. `budget` and
`study`, which need the extra `study`, are imported only where they are used.
"""

from kanegen.cli.app import main

__all__ = ["main"]
