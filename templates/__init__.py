"""Jinja templates, one folder for each target and one for artifacts, installed as `kanegen.templates`."""
