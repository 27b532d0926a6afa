"""Templates of the functions that follow a motion in steps: what all methods share, and one file a method."""
