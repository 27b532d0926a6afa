"""Times of calls of the generated C through other programs, beside calls of the C alone.

A module a target, with `measure() -> list[Row]`; `python -m benchmarks.embedding` finds and runs them. What
is not installed raises `kanegen.errors.MissingError` and is named on the page.
"""
