"""Compiled code on the machine: compilers, commands, the cache, and calls from Python.

`compilers` finds a compiler, `commands` runs it with a time limit, `selftest` tests its floating-point
arithmetic, `build` makes shared libraries and programs, and `cache` keeps them, in a folder that `ownership`
examines, for a machine that `processor` describes, within the limits of `environment`. A `facade` adds to a
library functions with the interface of another program. `calls` loads a
library and calls its functions with NumPy arrays, `status` reports what they return, `floating_point`
protects the process, and `openmp` a process that was forked. Every other package that compiles or runs a
program does it through these modules.
"""
