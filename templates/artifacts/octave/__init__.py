"""Templates of the artifact "octave": a mex file, and a package of functions that call it."""
