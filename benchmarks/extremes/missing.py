"""What the battery asks for and kanegen cannot be asked yet."""

from __future__ import annotations

MISSING = {
    "part of X9, quaternions": "needs joints whose coordinates are quaternions",
}
"""By number and subject: why."""
