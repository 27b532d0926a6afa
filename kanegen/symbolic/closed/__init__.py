"""Closed forms: [A] and {f} of a small tree without intermediates, simplified to be read.

`expanding` writes every entry as a polynomial (`polynomials`) in which equal parts are identical,
`angle_sums` shortens its trigonometric factors, `collecting` takes common factors out, and `form` puts the
steps together. What belongs here makes an expression shorter and keeps its value.
"""
