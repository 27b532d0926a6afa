"""Templates of the artifact "simulink": functions for the block C Caller, and how to set it up."""
