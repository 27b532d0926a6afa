"""The model: a tree of rigid bodies, the source language of kanegen.

Bodies, joints, points, force elements and parameters are frozen dataclasses of plain data, checked when they
are made. What follows from them by definition alone stands here too: orders and names of coordinates and
speeds, saving, re-anchoring, and the arrays that a caller passes. Equations of motion do not: a module here
may import `program` and the root modules, and nothing that derives, generates or compiles.
"""
