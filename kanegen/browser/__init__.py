"""Generated C in the reader's browser: WebAssembly of a source, and pages that step a model with it.

`toolchain` finds a compiler for WebAssembly and `wasm` compiles a source with it. What enters needs no server
and no network once it is written: a page holds its modules.
"""
