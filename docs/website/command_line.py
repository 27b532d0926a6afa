"""The page about the command line: every command with its arguments and options, from the program itself."""

import re
from collections.abc import Iterator
from typing import Any

import typer
from sphinx.application import Sphinx

from kanegen.cli.app import app as kanegen_app


def commands() -> Iterator[tuple[str, Any]]:
    """Yield every command, those of groups of commands included, under its full name."""
    waiting = [("kanegen", typer.main.get_command(kanegen_app))]
    while waiting:
        name, command = waiting.pop(0)
        inner = getattr(command, "commands", {})
        if not inner:
            yield name, command
        waiting += [(f"{name} {key}", value) for key, value in inner.items()]


def _arguments(command: Any, kind: str) -> list[Any]:
    return [one for one in command.params if one.param_type_name == kind and not one.hidden]


def _usage(name: str, command: Any) -> str:
    arguments = " ".join(one.metavar or one.name.upper() for one in _arguments(command, "argument"))
    required = " ".join(
        f"{one.opts[0]} {one.metavar or one.name.upper()}"
        for one in _arguments(command, "option")
        if one.required
    )
    return " ".join(filter(None, [name, arguments, required, "[OPTIONS]"]))


def _term(parameter: Any) -> str:
    """Return the names of an option with what it takes, or those of an argument."""
    if parameter.param_type_name == "argument":
        return f"`{parameter.metavar or parameter.name.upper()}`"
    names = ", ".join(f"`{name}`" for name in [*parameter.opts, *parameter.secondary_opts])
    return names if parameter.is_flag else f"{names} {parameter.metavar or parameter.name.upper()}"


def _ending(parameter: Any) -> str:
    """Return what is to be said about the default of an option."""
    if parameter.param_type_name == "argument" or parameter.is_flag:
        return ""
    if parameter.required:
        return " Required."
    default = parameter.default
    if default in (None, "", (), []) or callable(default):
        return ""
    values = default if isinstance(default, list | tuple) else [default]
    return " Default: " + ", ".join(f"`{value}`" for value in values) + "."


def _escaped(text: str) -> str:
    """Return help as Markdown in which brackets and stars are themselves, but for those in `code`."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(
        part if part.startswith("`") else re.sub(r"([\[\]*_<>|])", r"\\\1", part) for part in parts
    )


def section(name: str, command: Any) -> str:
    """Return what the page says about a command."""
    help_text = _escaped(command.help or "").strip()
    lines = [f"## {name}", "", help_text, "", "```console", f"$ {_usage(name, command)}", "```", ""]
    for parameter in [*_arguments(command, "argument"), *_arguments(command, "option")]:
        lines += [_term(parameter), f": {_escaped(parameter.help or '')}{_ending(parameter)}", ""]
    return "\n".join(lines)


def _add_commands(app: Sphinx, docname: str, source: list[str]) -> None:
    """Append a section for every command to the page."""
    if docname == app.config.command_line_page:
        source[0] += "\n\n" + "\n".join(section(name, command) for name, command in commands())


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect the page with Sphinx."""
    app.add_config_value("command_line_page", "command-line", "env")
    app.connect("source-read", _add_commands)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
