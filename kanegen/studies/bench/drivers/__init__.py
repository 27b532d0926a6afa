"""The drivers: C and C++ programs that call the code of a participant, write its results and time it.

`driver.h` is the interface of all of them and `driver.c` their main(); they are compiled when a comparison
needs them.
"""
