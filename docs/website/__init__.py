"""What makes a site of the pages in docs/: the configuration of Sphinx, and extensions of it beside it."""
