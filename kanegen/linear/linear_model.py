"""`LinearModel`: a state space that prints itself and that python-control takes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.extras import module
from kanegen.linear.model_html import model_html
from kanegen.linear.printing import render
from kanegen.linear.state_space import StateSpace

EXTRA = "control"
"""The extra that installs python-control."""


@dataclass(frozen=True, eq=False, repr=False)
class LinearModel(StateSpace):
    """Small deviations from a state: d/dt {xi} = [A]{xi} + [B]{u}, {eta} = [C]{xi} + [D]{u}.

    `StateSpace` has the attributes. All numbers are in SI units.

    Example:
        model = kg.linearize(kg.load("models/cart_pole.toml"), inputs=["cart_position"])
        model.A, model.B
        print(model)
        model.controllability.is_complete
    """

    def __repr__(self) -> str:
        """The name of the system and the numbers of states, inputs and outputs."""
        states, inputs, outputs = map(len, (self.state_names, self.input_names, self.output_names))
        return f"<LinearModel of {self.name}: {states} states, {inputs} inputs, {outputs} outputs>"

    def __str__(self) -> str:
        """Matrices, modes, stability, controllability and observability as text."""
        return self.render()

    def _repr_html_(self) -> str:
        """Matrices, modes and what follows from them, for a notebook."""
        return model_html(self)

    def render(self, format_: str = "text") -> str:
        """Return the model as "text", "markdown", "latex", "json" or "python".

        Raises:
            OptionError: If there is no such format.

        Example:
            print(model.render("latex"))
        """
        return render(self, format_)

    def to_control(self) -> Any:
        """Return the minimal model as a `StateSpace` of python-control, with the names of its signals.

        A dot in a name becomes an underscore, as python-control has it. Without outputs all states are
        outputs.

        Raises:
            MissingError: If python-control is not installed (pip install 'kanegen[control]').

        Example:
            K, _, _ = control.lqr(model.to_control(), np.eye(4), np.eye(1))
        """
        control, one = module("control", extra=EXTRA), self.minimal
        outputs = one.output_names or one.state_names
        C, D = one.C, one.D
        if not one.output_names:
            C, D = np.eye(len(outputs)), np.zeros((len(outputs), len(one.input_names)))
        named = {"states": one.state_names, "inputs": one.input_names, "outputs": outputs}
        signals = {kind: [name.replace(".", "_") for name in names] for kind, names in named.items()}
        return control.ss(one.A, one.B, C, D, name=self.name, **signals)
