"""`python -m kanegen` is the command line."""

from kanegen.cli import main

main()
