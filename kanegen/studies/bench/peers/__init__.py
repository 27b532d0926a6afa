"""The contestants: kanegen itself and, each where it is installed, the programs beside which it is timed."""
