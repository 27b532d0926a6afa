"""Sweeps: one job in many variations of a system, on threads, processes or a cluster, with results on disk.

`axes` has what varies and `design` the rows that follow from it; `job` says what is computed in each row,
from `quantities` and `statistics`. `plan` builds the code; `chunk` computes some rows at once with it, and
`running` has all chunks computed by an executor from `executors`. `stores` keep finished chunks, and
`results` is what a user gets. Code here decides which rollouts run where; how a motion is computed stands in
`library`.
"""
