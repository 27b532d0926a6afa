"""FMUs for FMI 2.0 and 3.0: zip files with the description, the sources, and a library for each platform."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from kanegen.artifacts import ARTIFACTS, fmi
from kanegen.artifacts.fmi.files import HEADERS
from kanegen.c.provenance import with_provenance
from kanegen.c.source import Source
from kanegen.errors import OptionError
from kanegen.library.native import selftest
from kanegen.library.native.build import Product, made
from kanegen.products.compiled_file import Platforms
from kanegen.products.platforms import Platform, compiler_for, is_host
from kanegen.program import semantics

FOLDERS = {
    "x86_64-linux": "linux64",
    "x86_64-windows": "win64",
    "x86_64-darwin": "darwin64",
}
"""Names of platforms in FMI 2.0, where they differ from those of FMI 3.0."""

_MOMENT = (1980, 1, 1, 0, 0, 0)
"""The time of every file in the zip file, the first that there is: the same source gives the same bytes."""

_SOURCES = "sources/"


def name(source: Source, version: int) -> str:
    """Return the name of the FMU of a source for a version of FMI, 2 or 3."""
    return f"{source.model.name}_fmi{version}.fmu"


def require_compilers(platforms: Platforms) -> None:
    """Make sure that there is a compiler for every platform.

    Raises:
        BuildError: If there is none; the message says how to get it.
    """
    for platform in platforms:
        compiler_for(platform)


def fmu(source: Source, version: int, platforms: Platforms) -> bytes:
    """Return the FMU of a source.

    Args:
        source: Generated C.
        version: Version of FMI, 2 or 3.
        platforms: Platforms for which it has a library.

    Raises:
        OptionError: If the source cannot become an FMU.
        BuildError: If a compiler is missing or fails, or the cache folder cannot be used.

    Example:
        source = kg.generate(kg.load("models/double_pendulum.toml"), artifacts=["fmi3"])
        Path("double_pendulum.fmu").write_bytes(fmu(source, 3, chosen_platforms()))
    """
    if obstacle := ARTIFACTS[f"fmi{version}"].obstacle(source):
        raise OptionError(f"fmi{version}: {obstacle}")
    vendored = {f"{_SOURCES}{header}" for header in HEADERS[version]}
    files: dict[str, bytes] = {
        path: (text if path in vendored else with_provenance(path, text)).encode()
        for path, text in fmi.files(source, version).items()
    }
    sources = {path.removeprefix(_SOURCES): data for path, data in files.items() if path.startswith(_SOURCES)}
    for platform in platforms:
        folder = FOLDERS.get(platform.name, platform.name) if version == 2 else platform.name
        path = f"binaries/{folder}/{source.model.name}{platform.suffix}"
        files[path] = made(_library(source, sources, platform), Path.read_bytes)
    return _zipped(files)


def _library(source: Source, sources: Mapping[str, bytes], platform: Platform) -> Product:
    """Return the library of an FMU for a platform with the commands that make it.

    It is for every processor of the platform, and nothing but the functions of FMI can be seen from outside.
    """
    found = compiler_for(platform)
    portable = replace(source, variant=replace(source.variant, machine="portable"))
    flags = selftest.sound_flags(found, portable) if is_host(platform) else portable.variant.flags
    shared = () if platform.suffix == ".dll" else ("-fPIC",)
    command = (*found.command, "-std=c99", *shared, "-fvisibility=hidden", "-g0", "-I.", *flags)
    return Product(
        name=f"{source.model.name}{platform.suffix}",
        files={file: data.decode() for file, data in sources.items()},
        compile={file: command for file in sources if file.endswith(".c")},
        link=(*semantics.linker_flags(command), "-shared", "-s"),
        link_arguments=("-lm",),
        fingerprints=(found.fingerprint, platform.name),
        pieces=source.pieces,
    )


def _zipped(files: Mapping[str, bytes]) -> bytes:
    """Return a zip file, the same for the same files."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path, _MOMENT)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content)
    return data.getvalue()
