"""Straight-line programs: the intermediate form, what must hold for it, and what can be done with it."""
