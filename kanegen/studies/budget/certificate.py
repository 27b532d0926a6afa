"""The record that goes beside the C: what was asked, what was found, and all that it takes to find it again.

It is a JSON file. Its first line is the stamp of a generated file (`c.stamp`), so an edited one is known.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kanegen import __version__
from kanegen.c.provenance import is_unchanged, stamped
from kanegen.errors import CertificateError, KanegenError
from kanegen.options import Variant
from kanegen.readers.text import read_text
from kanegen.studies.tradeoff.variants import Candidate

KIND = "error and time of one variant of one model"
FORMAT = 1

SUFFIX = "_certificate.json"
"""What the name of the file ends in, after that of the model."""

Table = Mapping[str, Any]


@dataclass(frozen=True)
class Certificate:
    """What a certificate file holds; `content` is all of it as plain data.

    Attributes:
        content: By section, see `certified.certified`.
    """

    content: Table

    def text(self, name: str) -> str:
        """The file of this name."""
        return stamped(name, json.dumps(self.content, indent=2, allow_nan=False).removeprefix("{\n") + "\n")

    def section(self, name: str) -> Any:
        """One section.

        Raises:
            CertificateError: If it is missing.
        """
        if name not in self.content:
            raise CertificateError(f"it has no section {name!r}. Generate the model anew.")
        return self.content[name]

    @property
    def candidate(self) -> Candidate:
        """The variant that was chosen.

        Raises:
            CertificateError: If this version knows no such variant.
        """
        choices = self.section("variant")
        try:
            fields: dict[str, Any] = {n: tuple(v) if isinstance(v, list) else v for n, v in choices.items()}
            return Candidate(Variant(**fields))
        except (AttributeError, TypeError, KanegenError) as error:
            raise CertificateError(f"its variant is none: {error}") from None


def variant_table(variant: Variant) -> dict[str, Any]:
    """A variant as `Certificate.candidate` reads it."""
    return {name: list(value) if isinstance(value, tuple) else value for name, value in vars(variant).items()}


def read(path: Path) -> Certificate:
    """The certificate in a file.

    Raises:
        CertificateError: If it is none, was edited, or comes from another version; names the file.
        ReadError: If there is no such file, or it is not text.
    """
    text = read_text(path)
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise CertificateError(f"{path}: not a certificate: it is not valid JSON: {error}.") from None
    if not isinstance(content, dict) or content.get("kind") != KIND:
        raise CertificateError(f"{path}: not a certificate of kanegen.")
    if content.get("format") != FORMAT or content.get("generator") != __version__:
        raise CertificateError(
            f"{path}: made by kanegen {content.get('generator')}, this is {__version__}. Verify it with that "
            "version, or generate the model anew."
        )
    if not is_unchanged(text):
        raise CertificateError(f"{path}: edited since kanegen wrote it. Generate the model anew.")
    return Certificate(content)
