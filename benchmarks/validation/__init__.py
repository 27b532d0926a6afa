"""Cases that others have published, computed with the C that kanegen generates.

`python -m benchmarks.validation` runs every module of `cases` and writes docs/validation.md. A `Case` holds
what its source states beside what kanegen finds; `digits` integrates a motion in many digits where those of a
source are uncertain. A new case is one module in `cases`, its model in `models`, and its entry in
`cases.CASES`.
"""
