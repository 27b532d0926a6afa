"""Optional packages, which come with an extra of kanegen and are imported only when they are needed."""

from __future__ import annotations

import importlib
import importlib.util
from importlib import metadata
from pathlib import Path
from types import ModuleType

from kanegen.errors import MissingError

BENCH = "bench"
"""The extra that brings the peers of the benchmarks."""

CASADI = "casadi"
"""The extra that brings CasADi, which takes the equations into problems of optimisation."""

MUJOCO = "mujoco"
"""The extra that brings MuJoCo, whose compiler reads MJCF files."""

JAX = "jax"
"""The extra that brings JAX, which can call generated functions."""

TORCH = "torch"
"""The extra that brings PyTorch, of which generated functions become operators."""


def module(name: str, *needs: str, extra: str = BENCH) -> ModuleType:
    """Import and return a module of an optional package.

    Args:
        name: Full name of the module.
        needs: Further packages that the module imports.
        extra: Name of the extra that brings them all.

    Raises:
        MissingError: If a package is not installed.
    """
    for package in (name.partition(".")[0], *needs):
        require(package, extra)
    return importlib.import_module(name)


def is_installed(package: str) -> bool:
    """Return whether `package` can be imported, without importing it."""
    return importlib.util.find_spec(package) is not None


def require(package: str, extra: str = BENCH) -> Path:
    """Return the folder of an optional package, without importing it.

    Raises:
        MissingError: If the package is not installed; the message names the extra that brings it.
    """
    spec = importlib.util.find_spec(package)
    if spec is None or spec.origin is None:
        raise _missing(package, extra)
    return Path(spec.origin).parent


def headers(distribution: str, header: str) -> Path:
    """Return the include folder of a distribution that brings C++ headers.

    Raises:
        MissingError: If the distribution is not installed, or has no file `header`.
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
    """Return the error that a package is not installed."""
    return MissingError(f"the Python package {package} is not installed (pip install 'kanegen[{extra}]')")
