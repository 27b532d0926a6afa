"""The command line: one module a command, named after it, and `app`, which joins them.

Modules of commands hold signatures, help and what is printed. They import the compiler, SymPy and NumPy only
inside the function that runs, so that `--help` and `--version` answer at once. `options` and `budget_options`
hold what can be typed, `loading` makes a system of it, `terminal` prints. Nothing else may enter here: what a
command computes belongs to the compiler or to a study, and nothing imports this package.
"""

from kanegen.cli.app import main

__all__ = ["main"]
