"""Templates of the artifacts that stand beside generated code."""
