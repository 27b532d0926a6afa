"""Cases that others have published, computed with kanegen; and exact numbers for other programs.

`python -m benchmarks.validation` runs every module of `cases` and writes docs/validation.md. A `Case` holds
what its source states beside what generated C finds; `digits` integrates a motion in many digits where those
of a source are uncertain. A new case is one module in `cases`, its model in `models`, and its entry in
`cases.CASES`. `truth` writes docs/truth, in which `tree_numbers` describes systems as plain numbers.
"""
