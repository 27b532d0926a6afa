"""The version of kanegen, which the code that it generates also carries."""

__version__ = "0.1.0"
