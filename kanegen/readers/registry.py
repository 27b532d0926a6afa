"""The file formats that kanegen reads, and the choice of the reader for a file.

A further format is one module with a `Reader`, and one entry in `READERS`. Formats may share a suffix if they
are XML and differ in their root elements.
"""

from __future__ import annotations

from kanegen.errors import ReadError
from kanegen.readers import mjcf, toml, urdf
from kanegen.readers.reader import ModelFile, Reader

READERS: tuple[Reader, ...] = (toml.READER, urdf.READER, mjcf.READER)
"""Every format."""


def reader_of(file: ModelFile) -> Reader:
    """Return the reader of a file, by its suffix and, for XML, its root element.

    Raises:
        ReadError: If no reader has the suffix, or none with the suffix has the root element.
    """
    suffix = file.path.suffix.lower()
    readers = [reader for reader in READERS if reader.suffix == suffix]
    if not readers:
        *others, last = dict.fromkeys(reader.suffix for reader in READERS)
        hint = " Run xacro on it first." if suffix == ".xacro" else ""
        raise ReadError(f"{file.path}: kanegen reads {', '.join(others)} and {last} files.{hint}")
    for reader in readers:
        if not reader.root or reader.root == file.root.tag:
            return reader
    expected = " and ".join(f"{reader.format} files have <{reader.root}>" for reader in readers)
    hint = "".join(
        f" This is a {reader.format} file: let its name end in {reader.suffix}."
        for reader in READERS
        if reader.root == file.root.tag
    )
    raise file.root.error(f"the top element is <{file.root.shown}>, but {expected}.{hint}")
