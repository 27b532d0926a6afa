"""Eqs. (2)-(45) of the notes in SymPy, body by body."""
