"""Errors of results against the reference and against exact results, bounds on them, and times of programs.

- `comparison` compares a compiled library with the NumPy reference over random states; its outcome is a
  `report.Report`. This is what `kanegen.compare` and `kanegen check` do.
- `errors` defines the errors that every measurement shares, and their statistics over states.
- `compared` says what a comparison needs of a library, and `evaluation` is one entry in one state.
- `programs` measures closed forms, definitions, the reference and compiled C in the same states, and draws
  their errors: `Report.programs`, `Report.plot` and `kanegen check --plot`.
- `truth` is a package of its own (extra `truth`): exact results by ball arithmetic, conditioning, and bounds.
- `timing` turns the times of programs that take turns into statements about which one is faster.
- `machine` describes the machine on which times are taken.

A module belongs here if it evaluates finished programs, whoever wrote them: it sees a library only through a
protocol of the functions that it calls. Studies, which build and choose programs, stand above this package.
"""
