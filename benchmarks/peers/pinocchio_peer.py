"""Pinocchio in C++: headers of the Python packages `pin` and `cmeel-eigen`, one program for every model."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

import numpy as np

import kanegen as kg
from benchmarks.peers.building import CONTRACTED, MissingError, compiled, driver
from benchmarks.peers.joints import Joint
from kanegen.arrays import Floats

_BOOST = (  # Pinocchio's list of joints is longer than Boost's lists are by default
    "-std=c++17",
    "-DNDEBUG",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
)
_ONE_AT_A_TIME = threading.Lock()
"""The second who asks waits and finds the program made."""


def program() -> Path:
    """The driver, which takes minutes to compile once.

    Raises:
        MissingError: If the headers or a C++ compiler are missing.
    """
    include = _headers("libpinocchio", "pinocchio/algorithm/aba.hpp")
    eigen = _headers("cmeel-eigen", "eigen3/Eigen/Core") / "eigen3"
    flags = (*_BOOST, *CONTRACTED.flags, f"-I{include}", f"-I{eigen}")
    with _ONE_AT_A_TIME:
        return compiled("pinocchio", {"pinocchio.cpp": driver("pinocchio.cpp")}, flags)


def _headers(package: str, header: str) -> Path:
    """The include folder of a package from the Python index."""
    try:
        files = metadata.files(package) or []
    except metadata.PackageNotFoundError:
        raise MissingError(f"the Python package {package} is not installed") from None
    for file in files:
        if file.as_posix().endswith(f"include/{header}"):
            return Path(str(file.locate())).parents[len(Path(header).parts) - 1]
    raise MissingError(f"the Python package {package} has no {header}")


def table(system: kg.System, joints: Sequence[Joint]) -> str:
    """The model as drivers/pinocchio.cpp reads it."""
    return "\n".join([_words(system.values().gravity), *(_line(joint) for joint in joints), ""])


def _line(joint: Joint) -> str:
    placement, body = joint.placement, joint.body
    numbers = [placement.rotation, placement.position, [body.mass], body.centre, body.central_inertia]
    columns = " ".join(map(str, joint.columns))
    return f"{joint.parent} {joint.kind} {columns} {' '.join(_words(part) for part in numbers)}"


def _words(values: Floats | list[float]) -> str:
    return " ".join(repr(float(value)) for value in np.ravel(values))
