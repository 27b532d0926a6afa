"""kanegen's C timed beside other programs that compute the same: `kanegen bench` and `make bench`.

The programs come from the extra `bench`. None of them is needed: who is missing is named and left out.
"""

from kanegen.studies.bench.contest import compete
from kanegen.studies.bench.outcome import BenchOptions, Entry, Outcome

__all__ = ["BenchOptions", "Entry", "Outcome", "compete"]
