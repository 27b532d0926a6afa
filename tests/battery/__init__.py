"""The battery of extremes: experiments with generated code where arithmetic is hardest.

Every experiment has a number, X1 to X39, and yields rows; a row is a figure and the limit that it must meet.
`experiments` defines them, `measurement` computes errors against certified truth, `scenes` holds the trees,
`c_programs` the C programs that call generated code, and `report` and `plot` make docs/extremes.md.
`python -m tests.battery` runs the full size, test_extremes.py the quick one.
"""
