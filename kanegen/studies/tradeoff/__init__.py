"""Speed against accuracy: every variant of a model measured, and which of them are worth having.

The extra `study` brings what this needs: certified truth, rank correlations and pictures. The module `study`
has the study itself.
"""

EXTRA = "study"
"""What to install."""

NEEDS = ("flint", "matplotlib", "scipy")
"""Packages that it brings."""
