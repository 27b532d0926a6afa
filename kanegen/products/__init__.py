"""Files that a compiler makes of a source, such as a module of WebAssembly.

A product is a `CompiledFile`: its name, the file, the tools that it needs, and a function from a `Source` to
the bytes of the file. `PRODUCTS` is the table of all, and `export` writes one. A text that needs no compiler
is an artifact and stands in `kanegen.artifacts`.
"""

from kanegen.products.compiled_file import CompiledFile
from kanegen.products.exporting import compiled_files, export, require_tools
from kanegen.products.platforms import PLATFORMS, Platform, chosen_platforms
from kanegen.products.table import PRODUCTS

__all__ = [
    "PLATFORMS",
    "PRODUCTS",
    "CompiledFile",
    "Platform",
    "chosen_platforms",
    "compiled_files",
    "export",
    "require_tools",
]
