"""How everything grows with the number of bodies; `python -m benchmarks.growth` writes docs/growth.md."""
