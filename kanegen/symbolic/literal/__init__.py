"""Eqs. (2)-(45) of the notes in SymPy, literally and body by body.

The equations of a body come in four layers, each a class that extends the one before: `joint`, Eqs. (1)-(9),
`angular_motion`, Eqs. (2)-(20), `linear_motion`, Eqs. (21)-(35), and `dynamics`, Eqs. (36)-(44).
`force_elements` adds springs, drives, potentials and loads on points, `numeric` evaluates the result.
Everything here follows the notes' matrices; nothing is rearranged to save operations.
"""
