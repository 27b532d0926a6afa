"""From the recursive form to programs of instructions, with derivatives and the decision about refinement."""
