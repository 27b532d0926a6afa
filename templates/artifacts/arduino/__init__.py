"""Jinja templates of a library for Arduino and other microcontrollers."""
