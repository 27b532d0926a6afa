"""Every MJCF file of gymnasium, dm_control and gymnasium-robotics beside MuJoCo, as a document.

`python -m tests.readers.mjcf_models > docs/mjcf-models.md` writes it. The packages are needed for their files
only: `pip install --no-deps gymnasium dm_control gymnasium-robotics`.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from dataclasses import replace
from importlib import metadata, util
from pathlib import Path

import numpy as np

import kanegen as kg
from kanegen.errors import KanegenError
from tests.support.mujoco_models import MujocoModel, errors

PACKAGES = ("gymnasium", "dm_control", "gymnasium_robotics")

HEAD = """# MJCF files of public packages

Every file with a model of MuJoCo in {packages},
read by kanegen and compared with MuJoCo {mujoco} in five random states with random inputs of the actuators:
[A] with its inertia matrix, {{f}} with the sum of its forces, {{ẏ}} with its accelerations without
constraints and without what is left out. Errors are relative: of [A] to its diagonal, of {{f}} to the largest
force, of {{ẏ}} to the largest acceleration. *n* counts the freedoms of kanegen; where couplings take freedoms
out, the comparison is without couplings. `python -m tests.readers.mjcf_models` writes this page.

| file | bodies | *n* | inputs | coupled | [A] | {{f}} | {{ẏ}} | left out |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |"""


PARTS = ("no joint of this model moves", "the top element is <")
"""Reasons for which files are refused that are parts of models, not models."""


def model_files() -> Iterator[tuple[str, Path]]:
    """Yield every file whose root element is that of a model, with its name in its package."""
    for package in PACKAGES:
        spec = util.find_spec(package)
        assert spec is not None and spec.origin is not None, f"{package} is not installed"
        folder = Path(spec.origin).parent
        for path in sorted(folder.rglob("*.xml")):
            yield path.relative_to(folder.parent).as_posix(), path


def row(name: str, path: Path) -> str:
    """Return the row of a file in the table.

    Raises:
        KanegenError: If kanegen does not read the file.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        system = kg.load(path)
    text = " ".join(str(warning.message) for warning in caught)
    parts = re.findall(r"(?:leave out|;) ([^();]+?) \(", text)
    mujoco, rng = MujocoModel(path, full := replace(system, couplings=())), np.random.default_rng(0)
    worst = np.max([errors(full, mujoco, rng) for _ in range(5)], axis=0)
    columns = [len(system.bodies), len(system.freedoms), len(system.parameters), len(system.couplings)]
    cells = [*map(str, columns), *(f"{error:.0e}" for error in worst), "; ".join(parts)]
    return f"| {name} | {' | '.join(cells)} |"


def main() -> None:
    """Print the document."""
    versions = ", ".join(f"{package} {metadata.version(package)}" for package in PACKAGES)
    print(HEAD.format(packages=versions, mujoco=metadata.version("mujoco")))
    refused: dict[str, str] = {}
    for name, path in model_files():
        try:
            print(row(name, path), flush=True)
        except KanegenError as error:
            folder = str(path).removesuffix(name)
            refused[name] = str(error).removeprefix(str(path)).lstrip(":0123456789 ").replace(folder, "")
    of_parts = [name for name, reason in refused.items() if reason.startswith(PARTS)]
    print(f"\nNo joint moves in these {len(of_parts)} files, or they are parts that other files include:\n")
    print("\n".join(f"- {name}" for name in of_parts))
    print("\nThese files are refused by MuJoCo:\n\n| file | reason |\n| --- | --- |")
    for name, reason in refused.items():
        if name not in of_parts:
            print(f"| {name} | {reason} |")


if __name__ == "__main__":
    main()
