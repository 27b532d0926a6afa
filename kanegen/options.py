"""The choices that trade speed for accuracy, as one value that goes with the C it shaped.

Every field is an explicit option of the generator or the compiler; named tiers are bundles of them. What a
choice costs and what error it has is measured, never assumed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from types import MappingProxyType

from kanegen.choices import require_one
from kanegen.errors import OptionError
from kanegen.program import passes
from kanegen.program import precision as precisions
from kanegen.program import semantics as rules

SOLVERS = ("cheapest", "articulated bodies", "factorisation")
"""Ways to {ydot}: the cheapest by operation count among those that lose no accuracy, or one by name."""

SINCOS = ("shared", "libm", *(f"polynomial-{degree}" for degree in range(5, 16, 2)))
"""Sine and cosine: kanegen's own, with the same bits everywhere; those of the C library; or polynomials of
this degree and the next, whose errors the C states."""


NOTHING: Mapping[str, str] = MappingProxyType({})

AUTO = "auto"
"""Refinement where the model needs it."""

REFINEMENTS = (0, 1, 2, AUTO)
"""Steps of iterative refinement in forward dynamics."""


def _words(value: object) -> str:
    if isinstance(value, tuple):
        return ", ".join(map(str, value)) or "none"
    return str(value) or "own"


@dataclass(frozen=True)
class Variant:
    """One way to compute the equations of a tree.

    Attributes:
        precision: Arithmetic, a name of `precision.PRECISIONS`.
        solver: Way to {ydot}, one of `SOLVERS`.
        without: Passes of the optimiser that are left out.
        semantics: What the compiler may do to arithmetic, names of `semantics.SEMANTICS`.
        machine: What the code may run on, one of `semantics.MACHINES`.
        optimisation: The compiler's level, one of `semantics.OPTIMISATIONS`.
        sincos: Sine and cosine, one of `SINCOS`.
        refinement: Steps of iterative refinement in forward dynamics, one of `REFINEMENTS`.
        storage: Type of the arrays, a name of `precision.PRECISIONS`; "" for the own one of `precision`.
    """

    precision: str = "double"
    solver: str = "cheapest"
    without: tuple[str, ...] = ()
    semantics: tuple[str, ...] = (rules.STRICT,)
    machine: str = "portable"
    optimisation: int = 2
    sincos: str = "shared"
    storage: str = ""
    refinement: int | str = AUTO

    def __post_init__(self) -> None:
        """Check every choice.

        Raises:
            OptionError: If one does not exist.
        """
        precisions.storage_precision(self.precision, self.storage)
        require_one("solver", self.solver, SOLVERS)
        require_one("refinement", self.refinement, REFINEMENTS)
        require_one("machine", self.machine, rules.MACHINES)
        require_one("sincos", self.sincos, SINCOS)
        self._require_sincos()
        require_one("optimisation", self.optimisation, rules.OPTIMISATIONS)
        object.__setattr__(self, "without", passes.checked_names(self.without))
        object.__setattr__(self, "semantics", rules.checked_semantics(self.semantics))
        self._require_properties()

    def _require_properties(self) -> None:
        missing = precisions.precision_named(self.precision).required_properties.difference(
            rules.guaranteed_properties(self.semantics)
        )
        if missing:
            raise OptionError(
                f"precision {self.precision!r} needs {', '.join(sorted(missing))}, which semantics "
                f"{', '.join(self.semantics)} give up. Take strict semantics."
            )

    def _require_sincos(self) -> None:
        """Other precisions have one accurate way, and none of the C library has pairs."""
        known = {"long double": ("shared", "libm"), "double-double": ("shared",)}.get(self.precision, SINCOS)
        if self.sincos not in known:
            raise OptionError(
                f"sincos {self.sincos!r} does not go with precision {self.precision!r}, "
                f"which takes {' or '.join(known)}."
            )

    @property
    def flags(self) -> tuple[str, ...]:
        """Flags by which gcc and clang honour it."""
        return rules.compiler_flags(self.semantics, self.machine, self.optimisation)

    @property
    def flushes(self) -> bool:
        """Whether subnormal numbers count as zero."""
        return rules.FLUSH in self.semantics

    @property
    def is_strict(self) -> bool:
        """Whether no bit depends on the compiler."""
        return self.semantics == (rules.STRICT,)

    def described(self, decided: Mapping[str, str] = NOTHING) -> tuple[tuple[str, str], ...]:
        """Every choice as a pair of words, in the order of the fields; some of them as `decided`."""
        values = ((field.name, getattr(self, field.name)) for field in fields(self))
        return tuple((name, decided.get(name, _words(value))) for name, value in values)


TIERS = {
    "strict": Variant(),
    "fast": Variant(semantics=rules.RELAXED, machine="native", optimisation=3),
    "single": Variant(precision="float"),
    "exact": Variant(precision="double-double", refinement=1),
}
"""Variants by the name of the promise that they keep."""

STRICT = TIERS["strict"]
"""What is generated unless something else is asked for."""


def chosen_variant(
    tier: Variant | str = STRICT,
    *,
    precision: str | None = None,
    without: Iterable[str] | None = None,
    storage: str | None = None,
    sincos: str | None = None,
) -> Variant:
    """A variant, or the tier of that name, with some choices changed.

    Raises:
        OptionError: If there is no such tier or choice.
    """
    if not isinstance(tier, Variant):
        require_one("tier", tier, TIERS)
        tier = TIERS[tier]
    if precision is not None:
        tier = replace(tier, precision=precision)
    if storage is not None:
        tier = replace(tier, storage=storage)
    if sincos is not None:
        tier = replace(tier, sincos=sincos)
    if without is not None:
        tier = replace(tier, without=passes.checked_names(without))
    return tier


Progress = Callable[[str], None]
"""Told the name of each stage as it begins."""


def quiet(stage: str) -> None:
    """Progress that nobody watches."""
