"""Times of rollouts: kanegen's C beside loops of others over their forward dynamics, on the same motions."""
