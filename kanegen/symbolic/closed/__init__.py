"""Closed forms: [A] and {f} without intermediates, brought into their shortest form."""
