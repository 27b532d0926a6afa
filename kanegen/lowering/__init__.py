"""The way from a request to a program of instructions: acceptance, conditioning, lowering and derivatives.

`accept` checks the request, `conditioning` chooses the solvers and the number of refinement steps, `lower`
turns every definition of the recursive form into instructions, and `differentiate`
adds the derivatives. Only code that needs both the equations and the program representation belongs here:
mechanics belongs to `recursion`, passes over programs to `program`.
"""
