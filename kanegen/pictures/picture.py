"""`Picture`: an SVG that a notebook shows and that can be written into a file."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from kanegen.files import path_of, write_whole


@dataclass(frozen=True)
class Picture:
    """A picture as SVG, which notebooks show; in a browser, parts of it have titles under the pointer.

    Attributes:
        svg: The text of the picture.

    Example:
        >>> picture = kg.load("models/eight_body.toml").picture()
        >>> picture.write("tree.svg")
    """

    svg: str = field(repr=False)

    def write(self, file: str | Path) -> None:
        """Write the picture into a file.

        Raises:
            WriteError: If the file is no path or cannot be written.

        Example:
            >>> picture.write("tree.svg")
        """
        write_whole(path_of(file), self.svg)

    def _repr_svg_(self) -> str:
        """Return the picture for a notebook."""
        return self.svg
