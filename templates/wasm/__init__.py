"""Headers and functions of C that WebAssembly without a C library needs."""
