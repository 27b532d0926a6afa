"""What comes from an extra, mostly `bench`, imported or looked for only when it is needed."""

from __future__ import annotations

import importlib
import importlib.util
from importlib import metadata
from pathlib import Path
from types import ModuleType

from kanegen.errors import MissingError

BENCH = "bench"
"""The extra that brings peers."""


def module(name: str, *needs: str, extra: str = BENCH) -> ModuleType:
    """The module `name`.

    Args:
        name: Of the module.
        needs: Packages without which it could not be imported, beside its own.
        extra: What brings them all.

    Raises:
        MissingError: If a package is not installed.
    """
    for package in (name.partition(".")[0], *needs):
        require(package, extra)
    return importlib.import_module(name)


def is_installed(package: str) -> bool:
    """Whether `package` can be imported; it is not imported."""
    return importlib.util.find_spec(package) is not None


def require(package: str, extra: str = BENCH) -> Path:
    """The folder of the importable `package`, which is not imported.

    Raises:
        MissingError: If it is not installed; names the `extra` that brings it.
    """
    spec = importlib.util.find_spec(package)
    if spec is None or spec.origin is None:
        raise _missing(package, extra)
    return Path(spec.origin).parent


def headers(distribution: str, header: str) -> Path:
    """The include folder of a distribution that brings C++ headers.

    Raises:
        MissingError: If it is not installed, or without `header`.
    """
    try:
        files = metadata.files(distribution) or []
    except metadata.PackageNotFoundError:
        raise _missing(distribution, BENCH) from None
    for file in files:
        if file.as_posix().endswith(f"include/{header}"):
            return Path(str(file.locate())).parents[len(Path(header).parts) - 1]
    raise MissingError(f"the Python package {distribution} has no {header}")


def _missing(package: str, extra: str) -> MissingError:
    return MissingError(f"the Python package {package} is not installed (pip install 'kanegen[{extra}]')")
