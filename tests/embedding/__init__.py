"""Each program in which generated C is embedded: the real consumer computes the same numbers."""
