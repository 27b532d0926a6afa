"""From a request to a program of instructions: acceptance, conditioning, lowering and derivatives.

`accept` checks what is to be compiled, `conditioning` decides by which solvers and with how much refinement
it is derived, `lower` turns every definition of the recursive form into instructions, and `differentiate`
adds the derivatives. Only what needs both the equations and the program representation enters here: mechanics
belongs to `recursion`, passes over programs to `program`.
"""
