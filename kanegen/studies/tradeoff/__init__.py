"""Speed against accuracy: every variant of a model is measured, and the Pareto front is confirmed.

`study.study` is the study itself, `report`, `tables` and `plot` write it down, and `simulation` compares
variants by the integration of a motion. `evaluator.VariantEvaluator` builds, measures and times
variants for this study and for `studies.budget`. The package needs the extra `study`, which brings certified
truth, rank correlations and pictures.
"""

EXTRA = "study"
"""The extra that installs the packages in `NEEDS`."""

NEEDS = ("flint", "matplotlib", "scipy")
"""The optional packages that a study needs."""
