"""The interface of a file format: suffix, root element of an XML format, and the reading function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from kanegen.errors import ReadError
from kanegen.model.right_angles import AS_WRITTEN
from kanegen.model.system import System
from kanegen.readers.encoding import utf8_text, xml_text
from kanegen.readers.visual import Visuals
from kanegen.readers.xml import Element, parse

FRICTION_SMOOTHING = 0.01
"""Rate within which friction is smoothed (rad/s, m/s), a hundredth of a usual speed. Explicit integration
with steps of a millisecond is stable where friction accelerates its joint by less than about 10 rad/s^2."""


@dataclass(frozen=True)
class ModelFile:
    """A file that describes a system; its contents are read on first use and kept."""

    path: Path

    @cached_property
    def text(self) -> str:
        """The text of a file in UTF-8.

        Raises:
            ReadError: If the file cannot be read or is not UTF-8.
        """
        return read_text(self.path)

    @cached_property
    def root(self) -> Element:
        """The root element of an XML file, in the encoding that it declares.

        Raises:
            ReadError: If the file cannot be read or is not well-formed XML.
        """
        return parse(xml_text(read_bytes(self.path), str(self.path)), str(self.path))


@dataclass(frozen=True)
class ReadOptions:
    """Options of `load`.

    Attributes:
        floating_base: Whether the root link of a robot file moves freely.
        right_angles: Tolerance (rad) within which constant orientations are made exact right angles.
        joint_dynamics: Whether damping and friction of the joints of a URDF file are read, and dry friction
            of those of an MJCF file.
    """

    floating_base: bool = False
    right_angles: float = AS_WRITTEN
    joint_dynamics: bool = False


@dataclass(frozen=True)
class Reader:
    """A file format that kanegen reads.

    Attributes:
        format: Name of the format, used in messages, such as "URDF".
        suffix: Suffix of its files in lower case, with the dot.
        read: Returns the system that a file describes. It raises `ReadError` with file and line.
        root: Name of the root element of an XML format; "" for a format that is not XML.
        visuals: Returns the shapes of a file, for pictures; None for a format that has none.
    """

    format: str
    suffix: str
    read: Callable[[ModelFile, ReadOptions], System]
    root: str = ""
    visuals: Callable[[ModelFile], Visuals] | None = None


def read_text(path: Path) -> str:
    """Return the text of a file in UTF-8, without a byte order mark.

    Raises:
        ReadError: If there is no such file, it cannot be read, or it is not UTF-8.
    """
    return utf8_text(read_bytes(path), str(path))


def read_bytes(path: Path) -> bytes:
    """Return the content of a file.

    Raises:
        ReadError: If there is no such file, or it cannot be read.
    """
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise ReadError(f"{path}: there is no such file.") from None
    except IsADirectoryError:
        raise ReadError(f"{path}: this is a folder, not a model file.") from None
    except (OSError, ValueError) as error:
        raise ReadError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}.") from None
