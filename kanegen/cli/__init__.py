"""The command line: `kanegen generate`, `check`, `equations` and `info`."""

from kanegen.cli.app import main

__all__ = ["main"]
