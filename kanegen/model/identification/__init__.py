"""Identification of inertial parameters: which there are, and which of them the motion of a tree shows.

`inertial_parameters` has the ten parameters of each body, in the order of the columns of the regressor.
Only what follows from the geometry of the joints belongs here; no equation of motion is formed.
"""
