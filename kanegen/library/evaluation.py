"""Several results under their names."""

from __future__ import annotations

from collections.abc import Sequence

from kanegen.model.arguments import Floats


class Evaluation(tuple[Floats, ...]):
    """Several outputs of one call, in order; each is also an attribute of its name."""

    _names: tuple[str, ...]

    def __new__(cls, names: tuple[str, ...], values: Sequence[Floats]) -> Evaluation:
        """`values` with their names."""
        self = tuple.__new__(cls, values)
        self._names = names
        return self

    def __getattr__(self, name: str) -> Floats:
        if name in self._names:
            return self[self._names.index(name)]
        raise AttributeError(f"there is no output {name!r} here, only {', '.join(self._names)}")

    def __getnewargs__(self) -> tuple[tuple[str, ...], tuple[Floats, ...]]:
        return self._names, tuple(self)

    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={value!r}" for name, value in zip(self._names, self, strict=True))
        return f"Evaluation({fields})"
