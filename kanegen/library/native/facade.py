"""Further C and C++ that is compiled together with generated code into one shared library.

A facade calls the generated functions and has the interface of another program: CasADi loads such a library
by `external`, JAX by its foreign function interface. Its code is that of an artifact, or is written for the
versions of packages on this machine.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

_STANDARDS = {".c": "-std=c99", ".cpp": "-std=c++17"}
"""Compiler flag of the language of a source file, by suffix."""


@dataclass(frozen=True)
class Facade:
    """Sources beside those of a model, and where their headers are.

    Attributes:
        name: Name of the shared library, without "lib" and suffix, such as "panda_arm_casadi".
        files: Texts of sources (.c, .cpp) and headers by relative path; none has the name of a file of the
            model.
        include: Folders of headers of other packages. Warnings about these headers are not shown.
        flags: Further compiler flags of the files, such as `("-fvisibility=hidden",)`.

    Raises:
        ValueError: If no file is C or C++.

    Example:
        >>> facade = Facade("arm_casadi", source.files)
        >>> build(source, facade=facade)
    """

    name: str
    files: Mapping[str, str]
    include: tuple[Path, ...] = ()
    flags: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Make sure that there is something to compile."""
        if not self.sources:
            raise ValueError(f"facade {self.name}: none of {', '.join(self.files)} ends in .c or .cpp.")

    @property
    def sources(self) -> tuple[str, ...]:
        """Names of the files that are compiled."""
        return tuple(file for file in self.files if Path(file).suffix in _STANDARDS)

    @property
    def is_cpp(self) -> bool:
        """Whether a file is C++, so that a C++ compiler is needed."""
        return any(file.endswith(".cpp") for file in self.sources)

    def options(self, file: str) -> tuple[str, ...]:
        """Return the compiler flags of one of its sources."""
        folders = [part for folder in self.include for part in ("-isystem", str(folder))]
        return (_STANDARDS[Path(file).suffix], *folders, "-I.", *self.flags)

    @property
    def fingerprint(self) -> str:
        """A text that differs where a header in one of the folders may have changed."""
        headers = sorted(path for folder in self.include for path in folder.rglob("*.h*") if path.is_file())
        return "\n".join(f"{path} {path.stat().st_size} {path.stat().st_mtime_ns}" for path in headers)
