"""Measurements for the documentation; `python -m benchmarks` times kanegen beside its peers."""
