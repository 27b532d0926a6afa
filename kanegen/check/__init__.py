"""Truth: the independent NumPy reference, comparisons with it, and what makes [A] singular."""
