"""The choices that trade speed for accuracy, as one value that is recorded in the generated C.

Every field is an explicit option of the generator or the compiler; named tiers are bundles of options. The
cost and the error of a choice are measured, never assumed.
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
"""Solvers of [A]{ydot} = {b}: the cheapest among those that lose no accuracy, or one by name."""

SINCOS = ("shared", "libm", *(f"polynomial-{degree}" for degree in range(5, 16, 2)))
"""Sine and cosine: kanegen's own, with the same bits everywhere; those of the C library; or polynomials of
this degree and the next, whose errors the generated C documents."""

NO_DECISIONS: Mapping[str, str] = MappingProxyType({})

AUTO = "auto"
"""Refinement of {ydot} where the model needs it; instructions of this processor where they change no bit."""

MACHINES = (AUTO, *rules.MACHINES)
"""Processors that code runs on: named ones, or those on which a library is loaded."""

REFINEMENTS = (0, 1, 2, AUTO)
"""Numbers of steps of iterative refinement in forward dynamics."""


def _as_text(value: object) -> str:
    """Return the value of a choice as it stands in generated code and reports."""
    if isinstance(value, tuple):
        return ", ".join(map(str, value)) or "none"
    return str(value) or "own"


@dataclass(frozen=True)
class Variant:
    """All choices between speed and accuracy.

    Attributes:
        precision: Arithmetic of the C, one of `precision.PRECISIONS`. Constants are computed in 96
            digits and rounded once.
        solver: Solver for {ydot}, one of `SOLVERS`.
        without: Passes of the optimiser that are left out, of `passes.PASS_NAMES`; the C then takes more
            operations for the same results.
        semantics: Changes of arithmetic that the C compiler is allowed, of `semantics.SEMANTICS`.
        machine: Processors that the code runs on, one of `MACHINES`. "portable" code runs on all of the
            architecture, "native" code on those like this one. "multiversioned" code runs on all of the
            architecture, too; on x86-64 it holds each function for SSE2, AVX2 and AVX-512, and runs the
            widest that the processor has. With "auto" generated code is portable; a library that is built
            and loaded here is native if the semantics are strict, which give the same bits.
        optimisation: Level of the C compiler, one of `semantics.OPTIMISATIONS`.
        sincos: Sine and cosine, one of `SINCOS`.
        refinement: Steps of iterative refinement in forward dynamics, one of `REFINEMENTS`.
        storage: Type of the arrays, one of `precision.PRECISIONS`; "" for that of `precision` itself.

    Raises:
        OptionError: If a choice is unknown, or two choices do not go together.

    Example:
        kg.build(system, tier=kg.Variant(precision="float", storage="double"))
    """

    precision: str = "double"
    solver: str = "cheapest"
    without: tuple[str, ...] = ()
    semantics: tuple[str, ...] = (rules.STRICT,)
    machine: str = AUTO
    optimisation: int = 2
    sincos: str = "shared"
    storage: str = ""
    refinement: int | str = AUTO

    def __post_init__(self) -> None:
        """Check every choice, and that they go together."""
        precisions.storage_precision(self.precision, self.storage)
        require_one("solver", self.solver, SOLVERS)
        require_one("refinement", self.refinement, REFINEMENTS)
        require_one("machine", self.machine, MACHINES)
        require_one("sincos", self.sincos, SINCOS)
        self._require_sincos()
        require_one("optimisation", self.optimisation, rules.OPTIMISATIONS)
        object.__setattr__(self, "without", passes.checked_names(self.without))
        object.__setattr__(self, "semantics", rules.checked_semantics(self.semantics))
        self._require_properties()
        self._require_versions()

    def _require_properties(self) -> None:
        """Check that the semantics keep the properties of arithmetic that the precision relies on."""
        missing = precisions.precision_named(self.precision).required_properties.difference(
            rules.guaranteed_properties(self.semantics)
        )
        if missing:
            raise OptionError(
                f"precision {self.precision!r} needs {', '.join(sorted(missing))}, which semantics "
                f"{', '.join(self.semantics)} give up. Take strict semantics."
            )

    def _require_sincos(self) -> None:
        """Check that there are such sines and cosines in the precision."""
        known = {"long double": ("shared", "libm"), "double-double": ("shared",)}.get(self.precision, SINCOS)
        if self.sincos not in known:
            raise OptionError(
                f"sincos {self.sincos!r} does not go with precision {self.precision!r}, "
                f"which takes {' or '.join(known)}."
            )

    def _require_versions(self) -> None:
        """Check that all versions of multiversioned code can compute the same bits, in vectors."""
        if not self.is_multiversioned:
            return
        if not self.is_strict:
            raise OptionError(
                f"machine {self.machine!r} needs strict semantics: with {', '.join(self.semantics)} the "
                "results would depend on the processor. Leave them out, or take machine 'portable'."
            )
        if self.precision not in (precisions.DOUBLE.name, precisions.FLOAT.name):
            raise OptionError(
                f"machine {self.machine!r} does not go with precision {self.precision!r}, for which there "
                "are no vectors. Take 'double' or 'float', or machine 'portable'."
            )

    @property
    def is_multiversioned(self) -> bool:
        """Whether the code holds each function for several instruction sets."""
        return self.machine == rules.MULTIVERSIONED

    @property
    def flags(self) -> tuple[str, ...]:
        """Flags for code that goes elsewhere, for every gcc and clang: semantics, machine, optimisation."""
        machine = "portable" if self.machine == AUTO else self.machine
        return rules.compiler_flags(self.semantics, machine, self.optimisation)

    @property
    def flags_here(self) -> tuple[str, ...]:
        """Flags of gcc and clang for a library that is loaded on this machine only, by a tested compiler."""
        is_native = self.machine == "native" or (self.machine == AUTO and self.is_strict)
        machine = "native" if is_native else "portable"
        return rules.compiler_flags(self.semantics, machine, self.optimisation, is_tested=True)

    @property
    def flushes(self) -> bool:
        """Whether subnormal numbers are flushed to zero."""
        return rules.FLUSH in self.semantics

    @property
    def is_strict(self) -> bool:
        """Whether every compiler computes the same bits, but for the sign and the payload of a NaN."""
        return self.semantics == (rules.STRICT,)

    def choices(self, decided: Mapping[str, str] = NO_DECISIONS) -> tuple[tuple[str, str], ...]:
        """Return name and text of every choice, in the order of the attributes.

        Args:
            decided: Texts by name for choices that were decided later, such as automatic refinement.

        Example:
            dict(kg.Variant(precision="float").choices())["precision"]
        """
        values = ((field.name, getattr(self, field.name)) for field in fields(self))
        return tuple((name, decided.get(name, _as_text(value))) for name, value in values)


TIERS = {
    "strict": Variant(),
    "fast": Variant(semantics=rules.RELAXED, machine="native", optimisation=3),
    "single": Variant(precision="float"),
    "exact": Variant(precision="double-double", refinement=1),
}
"""Variants by the name of the promise that they keep: same bits, speed, single precision, exactness."""

STRICT = TIERS["strict"]
"""The variant that is generated unless another is asked for."""


def chosen_variant(
    tier: Variant | str = STRICT,
    *,
    precision: str | None = None,
    without: Iterable[str] | None = None,
    storage: str | None = None,
    sincos: str | None = None,
    machine: str | None = None,
) -> Variant:
    """Return a variant with some choices changed.

    Args:
        tier: The variant, or the name of one of `TIERS`.
        precision: Another precision; None leaves it as it is, here and below.
        without: Other passes to leave out.
        storage: Another type of the arrays.
        sincos: Other sines and cosines.
        machine: Other processors that the code runs on.

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
    if machine is not None:
        tier = replace(tier, machine=machine)
    if without is not None:
        tier = replace(tier, without=passes.checked_names(without))
    return tier


Progress = Callable[[str], None]
"""A function that is called with the name of each stage as it begins."""


def quiet(stage: str) -> None:
    """Ignore the name of a stage."""
