"""Folders in which nobody else can write, so that code in them is what kanegen has put there.

The rules are those of OpenSSH for the files of a user: the folder belongs to the user or to root, only the
user writes in it, and nobody else can replace a folder above it.
"""

from __future__ import annotations

import os
import stat
import sys
from pathlib import Path

if sys.platform != "win32":
    import grp
    import pwd

_ROOT = 0
"""User and group of the administrator."""

_OVERFLOW = Path("/proc/sys/kernel/overflowuid")
"""File with the number of all users that a container does not know, root of its host among them."""


def objection(folder: Path) -> str:
    """Return why others could replace what is in `folder`, with a remedy, or "" if they could not.

    Args:
        folder: A folder that exists. Links are followed: the folder to which they lead counts.

    Raises:
        OSError: If a folder above cannot be examined.
    """
    if sys.platform == "win32":
        return ""
    real = Path(os.path.realpath(folder))
    own = _written_by_others(real, real.stat(), _administrators())
    if own:
        return own
    for above in real.parents:
        found = above.stat()
        may_replace = not found.st_mode & stat.S_ISVTX  # with the sticky bit only owners rename and delete
        reason = _written_by_others(above, found, {*_administrators(), _unknown_user()})
        if reason and (may_replace or "belongs" in reason):
            return reason
    return ""


def is_private(path: Path) -> bool:
    """Return whether a file or folder, itself no link, belongs to the user or root and only they write it.

    Raises:
        OSError: If it cannot be examined.
    """
    found = path.lstat()
    if stat.S_ISLNK(found.st_mode):
        return False
    return sys.platform == "win32" or not _written_by_others(path, found, _administrators())


def _written_by_others(path: Path, found: os.stat_result, owners: set[int]) -> str:
    """Return why others can write `path`, with a remedy, or "" if only `owners` and own groups can."""
    if found.st_uid not in owners:
        return f"{path} belongs to user {found.st_uid}"
    mode = stat.S_IMODE(found.st_mode)
    group = mode & stat.S_IWGRP and not _is_own_group(found.st_gid)
    if group or mode & stat.S_IWOTH:
        return f"others can write {path}, mode {mode:04o}: `chmod go-w` it"
    return ""


def _administrators() -> set[int]:
    """Return the users whose files are trusted: the one of this process, and root."""
    return {os.getuid(), _ROOT} if sys.platform != "win32" else set()


def _unknown_user() -> int:
    """Return the number that stands for users outside a container, such as the owner of its root folder."""
    try:
        return int(_OVERFLOW.read_text())
    except (OSError, ValueError):
        return _ROOT


def _is_own_group(number: int) -> bool:
    """Return whether a group is root's, or the user's own, with the user's name and no other member."""
    if sys.platform == "win32" or number == _ROOT:
        return True
    try:
        user, group = pwd.getpwuid(os.getuid()).pw_name, grp.getgrgid(number)
    except KeyError:
        return False
    return group.gr_name == user and set(group.gr_mem) <= {user}
