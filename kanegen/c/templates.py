"""Loading and filling of the Jinja templates."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jinja2

from kanegen.model.quoting import c_name, c_text, markdown, markdown_code

_CHECKOUT = Path(__file__).parents[2] / "templates"
"""The folder of templates in a checkout; an installation has them as the package `kanegen.templates`."""


def _loader() -> jinja2.BaseLoader:
    if (_CHECKOUT / "c99" / "declarations.h.jinja").is_file():
        return jinja2.FileSystemLoader(_CHECKOUT)
    return jinja2.PackageLoader("kanegen.templates", "")


_ENVIRONMENT = jinja2.Environment(
    loader=_loader(),
    undefined=jinja2.StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
    autoescape=False,
)
_ENVIRONMENT.filters |= {"c_name": c_name, "c_text": c_text, "code": markdown_code, "markdown": markdown}


def fill(template: str, **context: Any) -> str:
    """Return the filled text of `template`, a file name without `.jinja`; a missing variable is an error."""
    return _ENVIRONMENT.get_template(f"{template}.jinja").render(**context)


def raw(name: str) -> str:
    """Return the text of a file that stands beside the templates, such as a script, as it is."""
    loader = _ENVIRONMENT.loader
    if loader is None:
        raise jinja2.TemplateNotFound(name)
    return loader.get_source(_ENVIRONMENT, name)[0]
