"""The growth of costs with the number of bodies; `python -m benchmarks.growth` writes docs/growth.md."""
