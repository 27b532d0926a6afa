"""Code in C between generated functions and JAX."""
