"""What comes from the extra `bench`, imported or looked for only when it is needed."""

from __future__ import annotations

import importlib
import importlib.util
from importlib import metadata
from pathlib import Path
from types import ModuleType

from kanegen.errors import MissingError

INSTALL = "pip install 'kanegen[bench]'"


def module(name: str) -> ModuleType:
    """The module `name`.

    Raises:
        MissingError: If its package is not installed.
    """
    require(name.partition(".")[0])
    return importlib.import_module(name)


def require(package: str) -> Path:
    """The folder of the importable `package`, which is not imported.

    Raises:
        MissingError: If it is not installed.
    """
    spec = importlib.util.find_spec(package)
    if spec is None or spec.origin is None:
        raise _missing(package)
    return Path(spec.origin).parent


def headers(distribution: str, header: str) -> Path:
    """The include folder of a distribution that brings C++ headers.

    Raises:
        MissingError: If it is not installed, or without `header`.
    """
    try:
        files = metadata.files(distribution) or []
    except metadata.PackageNotFoundError:
        raise _missing(distribution) from None
    for file in files:
        if file.as_posix().endswith(f"include/{header}"):
            return Path(str(file.locate())).parents[len(Path(header).parts) - 1]
    raise MissingError(f"the Python package {distribution} has no {header}")


def _missing(package: str) -> MissingError:
    return MissingError(f"the Python package {package} is not installed ({INSTALL})")
