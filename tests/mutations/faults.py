"""The table of small faults: the file, the text that is replaced, and the tests that should see it.

Every fault gives wrong numbers, reads or writes the wrong memory, or accepts what must be refused. Those that
change nothing have a reason and do not count.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

TABLE = Path(__file__).parent / "faults.toml"


@dataclass(frozen=True)
class Fault:
    """One change of one file.

    Attributes:
        file: Path of the file from the root of the repository.
        text: Text that occurs once in the file.
        replacement: Text that takes its place.
        tests: Test modules that should fail.
        harmless: Reason why the change makes no result wrong; "" where it does.
        unseen: Reason why no test sees it; "" where one does.
    """

    file: str
    text: str
    replacement: str
    tests: tuple[str, ...]
    harmless: str = ""
    unseen: str = ""

    @property
    def package(self) -> str:
        """Name of the package that has the fault, such as "kanegen/recursion"."""
        return str(Path(self.file).parent)

    def applied(self, content: str) -> str:
        """Return the content of the file with the fault.

        Raises:
            ValueError: If the text does not occur exactly once, since the file has changed meanwhile.
        """
        if content.count(self.text) != 1:
            raise ValueError(f"{self.file}: {self.text!r} occurs {content.count(self.text)} times, not once.")
        return content.replace(self.text, self.replacement)


def faults() -> Iterator[Fault]:
    """Yield all faults, file by file."""
    for file, entry in tomllib.loads(TABLE.read_text(encoding="utf-8")).items():
        for change in entry["faults"]:
            text, replacement, *rest = change
            reasons = dict(zip(rest[::2], rest[1::2], strict=True))
            yield Fault(file, text, replacement, tuple(entry["tests"]), **reasons)
