"""The equations of the notes in NumPy, independent of the compiler: the reference for generated code."""
