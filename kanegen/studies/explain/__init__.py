"""The cost report of a model: its specialised program beside the general program of the same tree.

`general_form` makes the general program and the steps from it to the model, `report` counts their operations,
`tables` and `page` show the result. `exactness` compares a model with the same model whose right angles are
exact.
"""

from kanegen.studies.explain.exactness import Exactness, exactness
from kanegen.studies.explain.report import CostReport, Step, cost_report

__all__ = ["CostReport", "Exactness", "Step", "cost_report", "exactness"]
