"""The intermediate representation of the compiler, and the transformations of it.

A program is straight-line code: a single-assignment list of scalar instructions from input arrays to output
arrays (`ir`), made by a `builder` and verified by `check`. `passes` reduce its number of operations, `split`
makes a program for each function, `arrange` and `cut` prepare long ones for a compiler, `tangent` and
`elimination` write derivatives and linear solves as instructions. `constants`, `precision` and `semantics`
describe the arithmetic in which the numbers of a program are computed.

Everything here holds for any straight-line program: nothing refers to bodies, joints, SymPy or C.
"""
