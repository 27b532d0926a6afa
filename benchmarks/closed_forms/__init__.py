"""Closed forms beside those of SymPy's KanesMethod and of textbooks: operations, values and times.

`kane` derives eleven systems as users of `sympy.physics.mechanics` do, `textbook` has their equations as
books print them, and `cases` brings both together with the model files. `python -m benchmarks.closed_forms`
writes docs/closed-forms.md.
"""
