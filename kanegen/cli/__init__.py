"""The command line: `kanegen generate`, `check`, `equations`, `info` and `bench`."""

from kanegen.cli.app import main

__all__ = ["main"]
