"""Programs beside each other: symbolic and numeric results on the same states, measured and drawn.

- `program` wraps what computes [A] and {f}: closed forms, definitions, the reference, compiled C.
- `yardstick` chooses the states and what errors are measured against, certified truth where there is one.
- `program_errors` are those of one program; `measured` holds those of all, their table and the worst states.
- `picture` draws them as SVG.

Certified truth and the picture need the extra `study`; without python-flint the reference takes its place.
"""

from kanegen.measure.programs.measured import Programs, measure_programs

__all__ = ["Programs", "measure_programs"]
