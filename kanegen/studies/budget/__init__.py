"""The fastest variant that keeps a budget of error, or the most accurate one that keeps a budget of time.

`certification.certify_variant` finds the variant by measuring and writes its certificate beside the C;
`verification.verify` checks whether a certificate still holds. What lives here: requests, regions of states,
the selection with its statistics, and certificates. The selection does not depend on C or on bodies; it takes
an `evaluator.Evaluator`. Variants, samples and their errors come from `studies.tradeoff`. The package
needs the extra `study`, so only the commands that use it import it.
"""
