"""kanegen's C timed beside other programs that compute the same: `kanegen bench` and `make bench`.

`compare` runs a comparison, `comparison` holds its result, `table` and `plot` show it. The programs stand in
`peers`, the C and C++ that calls them in `drivers`. Peers come from the extra `bench`; none is required, and
a missing one is named and left out. A new peer is one module in `peers`, one driver and one line of `PEERS`.
"""

from kanegen.studies.bench.compare import compare
from kanegen.studies.bench.comparison import BenchOptions, Comparison, Entry

__all__ = ["BenchOptions", "Comparison", "Entry", "compare"]
