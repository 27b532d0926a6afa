"""The pipeline.

    TOML / URDF / arrays
        |  readers      text -> System
    System
        |  symbolic     Eqs. (2)-(45) of the notes: the literal form to read, the recursive form for code
    Equations, RecursiveForm
        |  lowering     every definition becomes a few instructions
    Program
        |  passes       Program -> Program, counted
        |  split        the parameter-only part goes into `prepare`
    Module
        |  c            Jinja templates write header, source and what goes with them
    Source
        |  build        a C compiler, behind a cache
    Library             NumPy in, NumPy out
        |  check        against an independent NumPy reference
    Report
"""
