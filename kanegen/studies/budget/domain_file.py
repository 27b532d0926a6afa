"""A domain from a file, or from words on the command line."""

from __future__ import annotations

from pathlib import Path

from kanegen.model.system import System
from kanegen.readers.text import read_text
from kanegen.readers.toml import parsed
from kanegen.studies.budget.region import Region, region

OPTION = "--domain"


def read_domain(given: str | None, system: System) -> Region:
    """The region that an option `--domain` names.

    Args:
        given: A file that ends in .toml, or TOML as it would stand in one, with ";" instead of the ends of
            lines; None for the default.
        system: The tree.

    Raises:
        OptionError: If it describes no region of this system; names the file and the key.
        ReadError: If there is no such file, or it is no TOML.
    """
    if given is None:
        return region(system, {})
    if given.lower().endswith(".toml"):
        return region(system, parsed(read_text(Path(given)), given), given)
    return region(system, parsed(given.replace(";", "\n"), OPTION), OPTION)
