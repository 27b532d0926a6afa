"""The fastest variant under a budget of error, or the most accurate one under a budget of time.

`finding.find` chooses it and certifies what was found, `verification.verify` looks whether that still holds.
This needs the extra `truth`, so only the commands that use it import it.
"""
