"""The errors that kanegen raises, one class for each kind of mistake that a user can make.

Every class is a `KanegenError`, which is a `ValueError`, so one `except` catches them all. A message says
the mistake, its place and its remedy.
"""


class KanegenError(ValueError):
    """Base class of all errors that kanegen raises on purpose."""


class ModelError(KanegenError):
    """The system cannot exist: its connection array is bad, a mass is negative, a name is no name in C."""


class ReadError(ModelError):
    """A model file cannot be read; the message begins with the file and, where known, the line."""


class SingularError(ModelError):
    """[A] is singular in every state, or in the one asked about; the message names the freedom."""


class OptionError(KanegenError):
    """An option does not exist or does not fit, such as an unknown output."""


class ArrayError(KanegenError):
    """An array of states or loads has the wrong shape or type."""


class WriteError(KanegenError):
    """Files cannot be written to the folder."""


class BuildError(KanegenError):
    """There is no C compiler, or it failed; the message holds its command and its output."""


class MissingError(KanegenError):
    """An optional package is not installed, or another program lacks a feature that is needed."""


class BudgetError(KanegenError):
    """No variant keeps a budget of error or time; the message names the nearest variant and its figures."""


class CertificateError(KanegenError):
    """A certificate cannot be read, was edited, or belongs to another model or version."""


class KanegenWarning(UserWarning):
    """Kanegen accepts something unusual, such as moments of inertia that violate the triangle inequality."""
