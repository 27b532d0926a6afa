"""What a user can get wrong, one class a kind.

Every class is a `KanegenError`, which is a `ValueError`, so one `except` catches them all. Messages say
what is wrong, where, and how to mend it.
"""


class KanegenError(ValueError):
    """Root of everything that kanegen raises on purpose."""


class ModelError(KanegenError):
    """A system that cannot exist: a bad connection array, a negative mass, a hostile name."""


class ReadError(ModelError):
    """A model file that cannot be read; the message begins with the file and, where known, the line."""


class SingularError(ModelError):
    """A system whose [A] is singular in every state, or in the one asked about; names the freedom."""


class OptionError(KanegenError):
    """An option that does not exist or does not fit, such as an unknown output."""


class ArrayError(KanegenError):
    """A state or load array of the wrong shape or type."""


class WriteError(KanegenError):
    """A folder that cannot take the generated files."""


class BuildError(KanegenError):
    """No C compiler, or one that failed; the message holds its command and its output."""


class MissingError(KanegenError):
    """Something optional that is not installed, or a program beside kanegen that cannot do what is asked."""


class BudgetError(KanegenError):
    """A budget of error or time that no variant keeps; says how far one gets, and with which."""


class CertificateError(KanegenError):
    """A certificate that cannot be read, was edited, or belongs to another model or version."""


class KanegenWarning(UserWarning):
    """Something unusual that kanegen accepts, such as a violated triangle inequality."""
