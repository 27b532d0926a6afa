"""Identification of inertial parameters: which there are, and which of them the motions of a tree show.

`inertial_parameters` has the ten parameters of each body, in the order of the columns of the regressor, and
`base_parameters` the least number of combinations of them that forces and motions determine. `combinations`
finds these from the geometry alone (`single_joints`, `spaces`), `sampling` where freedoms are coupled or
prescribed. Only what follows from the geometry of the joints belongs here; no equation of motion is formed.
"""
