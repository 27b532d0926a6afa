"""`export`: one product of a model or of generated code, written to a file."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path, PurePosixPath

from kanegen.artifacts import ARTIFACTS
from kanegen.c.provenance import with_provenance_at_end
from kanegen.c.source import Source
from kanegen.choices import is_among, require_one, several
from kanegen.compiler import generate
from kanegen.errors import OptionError, quoted
from kanegen.files import path_of, require_writable, write_all
from kanegen.model.system import System
from kanegen.products.compiled_file import CompiledFile, Platforms
from kanegen.products.platforms import chosen_platforms
from kanegen.products.table import PRODUCTS


def export(
    model: System | Source, product: str, path: str | Path, platforms: Iterable[str] | str | None = None
) -> Path:
    """Write what a compiler makes of a model, such as a module of WebAssembly.

    Args:
        model: A system, of which C is generated with the outputs that the product needs; or generated C,
            where the outputs and other choices are the caller's.
        product: Name of the product, in `kanegen.products.PRODUCTS`.
        path: The file, which is replaced if it exists; or a folder, in which it is named after the model.
        platforms: Names of the platforms on which the file is to run, as FMI 3.0 writes them, such as
            "x86_64-windows". By default it is this machine's. Others need `pip install ziglang`.

    Returns:
        Path of the file.

    Raises:
        OptionError: If there is no such product or platform, or the model cannot have the product.
        BuildError: If a compiler is missing, or fails.
        WriteError: If the file cannot be written; nothing is then compiled.
        ModelError, SingularError: As `kanegen.generate`.

    Example:
        kg.export(kg.load("models/double_pendulum.toml"), "wasm", "double_pendulum.wasm")
    """
    _require_product(product)
    if not isinstance(model, System | Source):
        raise OptionError(f"export: {quoted(model)} is neither a system nor generated code.")
    chosen, named = PRODUCTS[product], path_of(path)
    on = platforms_of(chosen, platforms)
    chosen.require_tools(on)
    if not named.is_dir():
        require_writable(named)
    if isinstance(model, System):
        model = generate(model, artifacts=[product] if product in ARTIFACTS else [])
    file = named / chosen.file(model) if named.is_dir() else named
    write_all({file: chosen.make(model, on)})
    return file


def _require_product(name: str) -> None:
    """Make sure that there is a product of a name.

    Raises:
        OptionError: If there is none; the message says how to write the files of an artifact of that name.
    """
    if is_among(name, ARTIFACTS) and name not in PRODUCTS:
        raise OptionError(
            f"unknown product {quoted(name)}: no compiler makes one file of it. "
            f"Write its files with kg.generate(system, artifacts={name!r}).write(folder)."
        )
    if is_among(name, ("fmi", "fmu")):
        raise OptionError(f"unknown product {quoted(name)}. Did you mean 'fmi2' or 'fmi3'?")
    require_one("product", name, PRODUCTS)


def compiled_files(
    source: Source, products: Iterable[str], platforms: Iterable[str] | str | None = None
) -> dict[str, bytes]:
    """Return products of a source by the paths of their files, to be written beside the source.

    Each holds the line of provenance, so that the folder may be written again.

    Args:
        source: Generated code.
        products: Names of products, checked.
        platforms: As for `export`, for those products that have platforms.

    Raises:
        OptionError: If a platform is unknown, or the source cannot have a product.
        BuildError: If a compiler fails.
    """
    found = {}
    for name in products:
        product = PRODUCTS[name]
        content = product.make(source, _platforms_of_several(product, platforms))
        found[str(PurePosixPath(product.folder, product.file(source)))] = with_provenance_at_end(content)
    return found


def require_tools(products: Iterable[str], platforms: Iterable[str] | str | None = None) -> None:
    """Make sure that the tools for products are there, before long work.

    Raises:
        OptionError: If a product or a platform is unknown.
        BuildError: If a tool is missing; the message says how to get it.
    """
    for name in several("products", "product", products, PRODUCTS):
        product = PRODUCTS[name]
        product.require_tools(_platforms_of_several(product, platforms))


def _platforms_of_several(product: CompiledFile, names: Iterable[str] | str | None) -> Platforms:
    """Return the platforms of one of several products; one without platforms leaves them to others."""
    return platforms_of(product, names if product.has_platforms else None)


def platforms_of(product: CompiledFile, names: Iterable[str] | str | None) -> Platforms:
    """Return the platforms for which a product is made, () for one that is the same everywhere.

    Raises:
        OptionError: If there is no such platform, or the product has none.
        BuildError: As `chosen_platforms`.
    """
    if product.has_platforms:
        return chosen_platforms(names)
    if names is not None:
        raise OptionError(f"product {product.name!r} is the same on every platform. Leave out platforms.")
    return ()
