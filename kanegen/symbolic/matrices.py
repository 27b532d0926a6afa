"""`FiniteMatrix`: matrices of finite expressions, whose products skip entries that are zero."""

from __future__ import annotations

from collections import defaultdict
from typing import Any

from sympy import Expr, ImmutableMatrix
from sympy.polys.matrices import DomainMatrix
from sympy.polys.matrices.sdm import SDM


class FiniteMatrix(ImmutableMatrix):  # type: ignore[misc]  # SymPy has no types
    """A matrix whose entries are finite.

    SymPy's own product asks of every entry whether it may be infinite, because zero times infinity is no
    number, and these questions take longer than the product. Coordinates, speeds and numbers of a model are
    finite; so are sines, cosines and products of them.
    """

    def __new__(cls, *args: Any, **kwargs: Any) -> Any:
        """Return a matrix of this class, also from another immutable one, which SymPy would keep."""
        if len(args) == 1 and isinstance(args[0], ImmutableMatrix):
            return args[0] if isinstance(args[0], cls) else cls._fromrep(args[0]._rep)
        return super().__new__(cls, *args, **kwargs)

    def _plain(self, printer: Any) -> Any:
        """Return what a printer writes for SymPy's own class, which the code that it prints knows."""
        return printer.doprint(ImmutableMatrix._fromrep(self._rep))

    _pythoncode = _mpmathcode = _sympyrepr = _plain

    def _eval_matrix_mul(self, other: Any) -> Any:
        """Return the product with another matrix; entries that are zero take no part in it."""
        left, right = self._rep.unify(other._rep)
        if not left.domain.is_EXRAW:
            return super()._eval_matrix_mul(other)
        rows, columns = left.to_sparse().rep, right.to_sparse().rep
        found = {}
        for i, row in rows.items():
            terms: defaultdict[int, list[Expr]] = defaultdict(list)
            for k, factor in row.items():
                for j, entry in columns.get(k, {}).items():
                    terms[j].append(factor * entry)
            sums = {j: left.domain.sum(parts) for j, parts in terms.items()}
            if entries := {j: value for j, value in sums.items() if value}:
                found[i] = entries
        shape = (left.shape[0], right.shape[1])
        return self._fromrep(DomainMatrix.from_rep(SDM(found, shape, left.domain)))
