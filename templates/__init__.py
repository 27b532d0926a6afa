"""Jinja templates of the generated files, installed as `kanegen.templates`."""
