"""The artifact "certificate": the record of a search for code that keeps a budget of error or time.

It is a JSON file of the fields that `studies.budget` found; its first line is the line of provenance.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from kanegen.c.provenance import with_provenance
from kanegen.c.source import Source

SUFFIX = "_certificate.json"
"""End of the name of the file, after the name of the model."""


def certificate(source: Source) -> dict[str, str]:
    """Return the text of `<model>_certificate.json`, by its name."""
    return {f"{source.model.name}{SUFFIX}": json_text(source.certificate)}


def refusal(source: Source) -> str:
    """Return why `source` cannot have a certificate, "" if it can."""
    if source.certificate:
        return ""
    return "a certificate is for code that keeps a budget: give --error or --budget."


def json_text(fields: Mapping[str, Any]) -> str:
    """Return certificate fields as JSON without the first brace, which the line of provenance brings."""
    return json.dumps(fields, indent=2, allow_nan=False).removeprefix("{\n") + "\n"


def certificate_text(name: str, fields: Mapping[str, Any]) -> str:
    """Return the whole file of this name."""
    return with_provenance(name, json_text(fields))
