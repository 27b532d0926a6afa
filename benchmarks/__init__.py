"""Figures by which kanegen is judged; `python -m benchmarks` times it beside its peers."""
