"""The command line: one module a command, named after it, and `app`, which joins them.

Modules of commands hold signatures, help and printed text. They import the compiler, SymPy and NumPy only
inside the function that runs, so that `--help` and `--version` answer at once. `options` and `budget_options`
hold the arguments and options, `loading` reads the system, `terminal` prints. The computations of a command
belong to the compiler or to a study, not here; nothing imports this package.
"""

from kanegen.cli.app import main

__all__ = ["main"]
