"""How far results are from the truth: comparison with the reference, certified truth, bounds."""
