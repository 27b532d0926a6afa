"""The page that steps a model by its C in WebAssembly: scripts, style, and the document that holds them."""
