"""Addresses and C types of the functions of a loaded library, for programs that call them by themselves."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, quoted

_NUMBERS: dict[str, Any] = {
    "double": ctypes.c_double,
    "float": ctypes.c_float,
    "long double": ctypes.c_longdouble,
    "int": ctypes.c_int,
    "size_t": ctypes.c_size_t,
}
"""Types of ctypes by the names of C."""


class Entries:
    """The functions of a library by their names without the prefix of the model.

    The library stays in memory until the process ends, and so do its addresses.
    """

    def __init__(self, ffi: Any, library: Any, prefix: str) -> None:
        """Keep the declarations and the library of cffi; `prefix` begins every name in C."""
        self._ffi, self._library, self._prefix = ffi, library, f"{prefix}_"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all functions, without the prefix."""
        prefix = self._prefix
        return tuple(name.removeprefix(prefix) for name in dir(self._library) if name.startswith(prefix))

    def address(self, name: str) -> int:
        """Return the address of a function.

        Raises:
            OptionError: If there is no function of this name.
        """
        return int(self._ffi.cast("uintptr_t", self._found(name)))

    def prototyped(self, name: str) -> Callable[..., int]:
        """Return a function as ctypes calls it, with the types of its arguments.

        Raises:
            OptionError: If there is no function of this name.
        """
        kind = self._ffi.typeof(self._found(name))
        prototype = ctypes.CFUNCTYPE(_in_ctypes(kind.result), *map(_in_ctypes, kind.args))
        found: Callable[..., int] = prototype(self.address(name))
        return found

    def _found(self, name: str) -> Any:
        """Return a function as cffi calls it."""
        if name not in self.names:
            raise OptionError(f"there is no C function {quoted(name)}. {did_you_mean(name, self.names)}")
        return getattr(self._library, self._prefix + name)


def _in_ctypes(kind: Any) -> Any:
    """Return the type of ctypes for a type of cffi: a number, or a pointer to numbers."""
    if kind.kind == "pointer":
        return ctypes.POINTER(_NUMBERS[kind.item.cname.removeprefix("const ")])
    return _NUMBERS[kind.cname]
