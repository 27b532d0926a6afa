"""Native code: find a C compiler, compile once, load, call with NumPy arrays."""
