"""The battery of extremes: generated code where arithmetic is hardest, each row with the limit it must meet.

`python -m tests.battery` writes docs/extremes.md; tests/battery/test_extremes.py runs the quick size.
"""
