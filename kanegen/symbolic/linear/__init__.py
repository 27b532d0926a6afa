"""Linear models of small deviations from a state, in symbols.

`tangents` evaluates definitions and their derivatives in the state, so that no expression is differentiated
as a whole; `exact_numbers` keeps numbers exact on the way; `solving` solves with [A] in rational functions;
`linearization` puts the matrices together, and `symbolic_model` is the class that users get.
"""
