"""Templates of the target C99: a file each, and macros that several files share."""
