"""Studies of a model that build and measure many variants of it."""
