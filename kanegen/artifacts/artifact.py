"""The class of artifacts: a name, a sentence for users, and a function from a source to files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from kanegen.c.source import Source
from kanegen.choices import require_one
from kanegen.model.system import System
from kanegen.program.precision import PRECISIONS
from kanegen.recursion.outputs import RATES

WHOLE, ELEMENTS, ALL = "whole", "elements", "all"
"""How much of a symmetric matrix functions may fill for an artifact."""


def _never(source: Source) -> str:
    """Return the refusal of an artifact that can stand beside every source: none."""
    return ""


@dataclass(frozen=True)
class Artifact:
    """Optional files beside generated code, for one kind of user.

    Attributes:
        name: Name of the artifact, as users write it.
        summary: Purpose of the artifact, in one sentence.
        files: Function from a source to the text of each file, without the line of provenance. The key is the
            path of the file in the folder of the source, such as "rust/src/lib.rs".
        refusal: Function from a source to the reason why the source cannot have this artifact, "" if it can.
        is_default: Whether every source that can have the artifact gets it.
        outputs: Names of the outputs whose functions the artifact calls, or a function from a system to them.
            `generate` adds them where the user names no outputs.
        usual_outputs: Outputs, given in the same way, that `generate` adds as well where the user names no
            outputs, and that the artifact can do without.
        next_step: What users do next with the files, in a clause for the README; `{model}` is the name of the
            model.
        page: Path of the page on the artifact in kanegen's repository.
        precision: Precision of the arithmetic that the artifact takes where the user names none, one of
            `precision.PRECISIONS`; "" for that of the source.
        takes: How much of a symmetric matrix functions may fill for the artifact: "whole", "elements", which
            may be those of a triangle by themselves, or "all", also a triangle within the whole array.
        places: Names of its files, and of the folders of its files, in the folder of the source, as far as
            they do not begin with the name of the model, for which "{model}" stands.
        languages: Names of the targets beside whose code the artifact can stand.

    Raises:
        OptionError: If there is no such precision.

    Example:
        Artifact("certificate", "Records how a budget is kept.", certificate, refusal)
    """

    name: str
    summary: str
    files: Callable[[Source], Mapping[str, str]]
    refusal: Callable[[Source], str] = _never
    is_default: bool = False
    outputs: Sequence[str] | Callable[[System], Sequence[str]] = ()
    precision: str = ""
    usual_outputs: Sequence[str] | Callable[[System], Sequence[str]] = ()
    next_step: str = ""
    page: str = ""
    places: tuple[str, ...] = ()
    takes: str = ALL
    languages: tuple[str, ...] = ("c99",)

    def __post_init__(self) -> None:
        """Check that there is such a precision."""
        if self.precision:
            require_one("precision", self.precision, PRECISIONS)

    def needed_outputs(self, system: System) -> tuple[str, ...]:
        """Return the names of the outputs whose functions the artifact calls, for a system."""
        return tuple(self.outputs(system) if callable(self.outputs) else self.outputs)

    def added_outputs(self, system: System) -> tuple[str, ...]:
        """Return the names of the outputs that a source for the artifact has unless a user names others."""
        usual = self.usual_outputs(system) if callable(self.usual_outputs) else self.usual_outputs
        return (*self.needed_outputs(system), *usual)

    def obstacle(self, source: Source) -> str:
        """Return why a source cannot have the artifact, with how to mend it, "" if it can."""
        if why := self.refusal_of_language(source.target) or self._refusal_of_form(source):
            return why
        if why := self.refusal(source):
            return why
        if not callable(self.outputs):
            return self._lack(self.outputs, source)
        if source.system is None:
            return "this source does not carry its system. Generate it anew with kg.generate."
        return self._lack(self.outputs(source.system), source)

    def refusal_of_language(self, language: str) -> str:
        """Return why the artifact cannot stand beside code of a target, with how to mend it, or ""."""
        if language in self.languages:
            return ""
        return f"it is for C, not for {language}. Leave it out, or leave out the target {language!r}."

    def _refusal_of_form(self, source: Source) -> str:
        """Return why the artifact cannot have the form of [A], "" if it can."""
        arrays = [array for function in source.functions for array in function.outputs if array.pattern]
        if self.takes == ALL or not arrays or (self.takes == ELEMENTS and not arrays[0].is_filled_in_part):
            return ""
        forms = {WHOLE: '"full"', ELEMENTS: '"full", "packed" or "sparse"'}[self.takes]
        return f"it takes the mass matrix in the form {forms}. Choose it by --mass-matrix, or mass_matrix=..."

    @staticmethod
    def _lack(needed: Iterable[str], source: Source) -> str:
        """Return a sentence on the functions among `needed` that a source lacks, "" if it has all."""
        functions = {one.name for one in source.functions} | {one.name for one in source.rollouts}
        return lacking([name for name in needed if name not in functions])


def motion(system: System) -> tuple[str, ...]:
    """Return the outputs that simulations need: {ydot}, with contacts, too, and {xdot} unless it is {y}."""
    contacts = ("contact_dynamics",) if system.contacts else ()
    return (RATES[0], *contacts, *(() if system.speeds_are_rates else RATES[1:]))


def lacking(outputs: Sequence[str]) -> str:
    """Return a sentence on outputs that an artifact needs and a user's choice lacks, "" if there are none."""
    if not outputs:
        return ""
    options = " ".join(f"--output {name}" for name in outputs)
    return f"the code lacks {', '.join(outputs)}, which it calls. Add {options}, or name none."
