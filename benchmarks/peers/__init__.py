"""kanegen's C beside other programs that compute the same: `python -m benchmarks.peers`."""
