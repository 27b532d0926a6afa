"""Generated C becomes shared libraries and programs on disk, each compiled once and kept in the cache."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.c import Source
from kanegen.choices import chosen as several
from kanegen.choices import flag
from kanegen.errors import BuildError, quoted, warn
from kanegen.library.native import cache, commands, compilers, environment, processor, selftest
from kanegen.library.native.facade import Facade
from kanegen.program import precision as precisions
from kanegen.program import semantics
from kanegen.program.precision import LONG_DOUBLE

_LIBRARY_FLAGS = ("-std=c99", "-fPIC")
"""Compiler flags of generated code in every shared library."""

_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
"""End of the name of a shared library on this platform."""


@dataclass(frozen=True)
class Product:
    """A shared library or program, and everything that it depends on.

    Attributes:
        name: Name of its file.
        files: Texts of sources and headers by relative path.
        compile: For each source file the command that compiles it, without the names of files.
        link: Command that links the objects, without the names of files.
        link_arguments: Arguments of the linker after the objects, such as `("-lm",)`.
        fingerprints: Fingerprints of the compilers.
        seconds: Time limit for each file, s; None is the one of `environment.COMPILE_SECONDS`.
        pieces: Number of pieces of source files that are compiled in pieces, as in `Source.pieces`.
    """

    name: str
    files: Mapping[str, str]
    compile: Mapping[str, tuple[str, ...]]
    link: tuple[str, ...]
    link_arguments: tuple[str, ...]
    fingerprints: tuple[str, ...]
    seconds: float | None = None
    pieces: Mapping[str, int] = field(default_factory=dict)

    @property
    def objects(self) -> dict[str, list[str]]:
        """For each object file the command that makes it."""
        return {
            f"{stem}.o": [*command, *selected, "-c", file, "-o", f"{stem}.o"]
            for file, command in self.compile.items()
            for stem, selected in self._compiled(file)
        }

    def _compiled(self, file: str) -> list[tuple[str, list[str]]]:
        """Return for each object of a source file its name, without suffix, and the flags that select it."""
        if file not in self.pieces:
            return [(file, [])]
        return [(f"{file}.{i}", [f"-DKANEGEN_PIECE={i}"]) for i in range(self.pieces[file] + 1)]

    @property
    def key(self) -> str:
        """Name of its entry in the cache."""
        texts = [part for item in sorted(self.files.items()) for part in item]
        compile_ = map(shlex.join, self.objects.values())
        parts = [self.name, *texts, *compile_, *self.link, *self.link_arguments, *self.fingerprints]
        return cache.key([*parts, processor.fingerprint()])


@dataclass(frozen=True)
class Recipe:
    """What a shared library is compiled from and how.

    Attributes:
        source: Generated C, from `kanegen.generate`.
        compiler: Command of a compiler that takes gcc's options; None is that of `compilers.find`.
        flags: Compiler flags in place of those of the variant; None are those of the variant.
        threads: Whether OpenMP shares large batches among threads. With a compiler without OpenMP this gives
            a `KanegenWarning`, and batches use one thread.
        facade: Further C and C++ in the same library.
    """

    source: Source
    compiler: str | None = None
    flags: tuple[str, ...] | None = None
    threads: bool = False
    facade: Facade | None = None

    @classmethod
    def of(
        cls,
        source: Source,
        compiler: str | None,
        flags: str | Sequence[str] | None,
        threads: bool,
        facade: Facade | None = None,
    ) -> Recipe:
        """Return the recipe with flags that are a sequence or one text, split as a shell does it.

        Raises:
            BuildError: If the flags are neither, or the text cannot be split.
            OptionError: If `threads` is neither true nor false.
        """
        split = None if flags is None else _split(flags)
        return cls(source, compiler, split, flag("threads", threads), facade)

    def product(self) -> Product:
        """Return the library with the commands that make it.

        Raises:
            BuildError: If there is no compiler, or it does not keep what the variant promises.
            MissingError: If the facade is in C++ and there is no C++ compiler.
        """
        source = self.source
        found = compilers.find(self.compiler)
        chosen = selftest.sound_flags(found, source) if self.flags is None else self.flags
        _require_long_double(source)
        selftest.require(found, chosen, precisions.precision_named(source.precision).required_properties)
        if self.threads:
            chosen += _openmp_flags(found)
        command = (*found.command, *_LIBRARY_FLAGS, *chosen)
        files = code(source)
        product = Product(
            name=f"lib{source.model.name}{_SUFFIX}",
            files=files,
            compile={file: command for file in files if file.endswith(".c")},
            link=(*semantics.linker_flags(command), "-shared"),
            link_arguments=("-lm",),
            fingerprints=(found.fingerprint,),
            pieces=source.pieces,
        )
        return product if self.facade is None else _with_facade(product, self.facade, found, chosen)


def build(
    source: Source,
    compiler: str | None = None,
    flags: str | Sequence[str] | None = None,
    threads: bool = False,
    facade: Facade | None = None,
) -> Path:
    """Compile `source` to a shared library, unless the cache has it already.

    Args:
        source: Generated C, from `kanegen.generate`.
        compiler: Command of a compiler that takes gcc's options; by default that of `compilers.find`.
        flags: Compiler flags in place of those of the variant, as a sequence or as a shell would split them.
        threads: Whether OpenMP shares large batches among threads, as in `Recipe`.
        facade: Further C and C++ in the same library, with the interface of another program.

    Returns:
        Path of the shared library.

    Raises:
        BuildError: If there is no compiler, it fails or does not keep what the variant promises, or the
            cache folder cannot be used.
        MissingError: If the facade is in C++ and there is no C++ compiler.

    Example:
        >>> build(source, facade=Facade("arm_other", {"arm_other.c": text}))
        PosixPath('.../libarm_other.so')
    """
    return made(Recipe.of(source, compiler, flags, threads, facade).product(), Path)


def program(
    name: str,
    files: Mapping[str, str],
    flags: Mapping[str, Sequence[str]],
    link_arguments: Sequence[str] = ("-lm",),
    seconds: float | None = None,
) -> Path:
    """Compile a program from C and C++, unless the cache has it already.

    Args:
        name: Name of the program.
        files: Texts of sources and headers by relative path.
        flags: For each source file, which ends in .c or .cpp, the compiler flags. Headers are also looked
            for in the folder of the program.
        link_arguments: Arguments of the linker after the objects.
        seconds: Time limit for each file, s; by default there is none.

    Returns:
        Path of the program.

    Raises:
        BuildError: If there is no C compiler, it fails, or the cache folder cannot be used.
        TimeLimitError: If a file takes longer than `seconds`.
        MissingError: If there is C++ and no C++ compiler.
    """
    c = compilers.find()
    cpp = compilers.find_cpp() if any(file.endswith(".cpp") for file in flags) else c
    by_file = {file: cpp if file.endswith(".cpp") else c for file in flags}
    product = Product(
        name=name,
        files=files,
        compile={file: (*by_file[file].command, *own, "-I.") for file, own in flags.items()},
        link=cpp.command,
        link_arguments=tuple(link_arguments),
        fingerprints=(c.fingerprint, cpp.fingerprint),
        seconds=seconds,
    )
    return made(product, Path)


def made(product: Product, take: Callable[[Path], cache.Used]) -> cache.Used:
    """Return what `take` returns for the file of `product` in the cache, which is compiled if it is missing.

    Source files, and the pieces of long ones, are compiled at the same time.

    Args:
        product: The library or program.
        take: Function that loads or only names the file, as in `cache.use`.

    Raises:
        BuildError: If a compiler fails or the cache folder cannot be used.
        TimeLimitError: If a command exceeds the time limit of the product.
    """
    objects = product.objects

    def fill(folder: Path) -> None:
        seconds = environment.compile_seconds() if product.seconds is None else product.seconds
        write(product.files, folder)
        link = [*product.link, "-o", product.name, *objects, *product.link_arguments]
        try:
            commands.make_all(objects, folder, seconds)
            commands.make(link, product.name, folder, seconds)
        except commands.TimeLimitError as error:
            if product.seconds is not None:
                raise
            raise BuildError(
                f"{error} If the compiler does not hang, set ${environment.COMPILE_SECONDS} to more seconds."
            ) from error
        for file in objects:
            (folder / file).unlink()

    return cache.use(product.key, product.name, fill, take)


def code(source: Source) -> dict[str, str]:
    """Return the sources and headers of the library, without files of artifacts, by file name."""
    return {name: text for name, text in source.code.items() if name.endswith((".h", ".c"))}


def write(files: Mapping[str, str], folder: Path) -> None:
    """Write the texts `files`, by relative path, into `folder`."""
    for file, text in files.items():
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_text(text, encoding="utf-8", newline="\n")


def significand_bits(dtype: np.dtype[Any]) -> int:
    """Return the number of bits of the significand of a floating-point type on this platform."""
    return int(np.finfo(dtype).nmant) + 1


def _with_facade(product: Product, facade: Facade, c: compilers.Compiler, flags: tuple[str, ...]) -> Product:
    """Return the library of a source with a facade in it.

    Args:
        product: The library without the facade.
        facade: Further files.
        c: The C compiler.
        flags: Flags of the generated code that depend on neither language nor file.

    Raises:
        MissingError: If the facade is in C++ and there is no C++ compiler.
        ValueError: If a file has the name of one of the model.
    """
    if both := set(facade.files) & set(product.files):
        raise ValueError(f"facade {facade.name}: {', '.join(sorted(both))} is a file of the model, too.")
    cpp = compilers.find_cpp() if facade.is_cpp else c
    by_file = {file: cpp if file.endswith(".cpp") else c for file in facade.sources}
    own = {f: (*one.command, "-fPIC", *flags, *facade.options(f)) for f, one in by_file.items()}
    return replace(
        product,
        name=f"lib{facade.name}{_SUFFIX}",
        files={**product.files, **facade.files},
        compile={**product.compile, **own},
        link=(*semantics.linker_flags((*cpp.command, "-fPIC", *flags)), "-shared"),
        fingerprints=(c.fingerprint, cpp.fingerprint, facade.fingerprint),
    )


def _require_long_double(source: Source) -> None:
    """Make sure that `long double`, where the code uses it, is wider than double.

    Raises:
        BuildError: If `long double` has no more bits than double on this platform.
    """
    for name in (source.precision, source.storage):
        precision = precisions.precision_named(name)
        digits = significand_bits(precision.dtype)
        if name == LONG_DOUBLE.name and digits < precision.significand_bits:
            raise BuildError(
                f"precision {name!r}: long double has {digits} bits on this platform, no more than double. "
                "Use double-double."
            )


def _openmp_flags(compiler: compilers.Compiler) -> tuple[str, ...]:
    """Return the flag for threads, or nothing and a `KanegenWarning` if the compiler has no OpenMP."""
    if compilers.has_openmp(compiler):
        return (compilers.OPENMP,)
    warn(
        f"{shlex.join(compiler.command)} has no OpenMP, so batches use one thread. Install it, such as "
        "libomp for clang, or name another compiler."
    )
    return ()


def _split(flags: str | Sequence[str]) -> tuple[str, ...]:
    """Return flags one by one; one string is split as a shell does it."""
    try:
        found = tuple(shlex.split(flags)) if isinstance(flags, str) else several(flags)
    except ValueError:  # a quotation mark that is not closed
        found = None
    if found is None or not all(isinstance(one, str) and "\0" not in one for one in found):
        raise BuildError(f"flags: {quoted(flags)} are no flags. Give a string, or a sequence of strings.")
    return found
