"""The command line: `kanegen generate`, `verify`, `check`, `equations`, `info`, `bench` and `tradeoff`."""

from kanegen.cli.app import main

__all__ = ["main"]
