"""Templates of the artifact "rust": the files of a crate."""
