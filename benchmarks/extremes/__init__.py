"""The battery of extremes: generated code where arithmetic is hardest, each row with the limit it must meet.

`python -m benchmarks.extremes` writes docs/extremes.md; tests/test_extremes.py runs the quick size.
"""
