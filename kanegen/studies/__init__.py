"""Studies of a model that build, compare and measure many programs for it.

`bench` compares the C with other programs, `explain` counts the operations of the C, `tradeoff` measures the
speed and the accuracy of all variants of the C, and `budget` finds the variant that keeps a budget and
certifies it. A study uses the compiler and the library like any other caller; nothing below the command line
imports a study.
"""
