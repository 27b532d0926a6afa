"""Closed forms: [A] and {f} of a small tree without intermediates, simplified to be read.

`expanding` writes every entry as a polynomial (`polynomials`) in which equal parts are identical,
`angle_sums` shortens its trigonometric factors, `collecting` takes common factors out, and `form` puts the
steps together. Only transformations that shorten an expression and keep its value belong here.
"""
