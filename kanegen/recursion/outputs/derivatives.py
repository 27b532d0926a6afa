"""The part of the table of outputs that are derivatives of other outputs, by state, {tau} and parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from kanegen.recursion.outputs.output import Derivative, Output

_DIFFERENTIATED = (
    ("forcing", "{f}, Eq. (44),", ("x", "y")),
    ("gravity_forces", "the part of {f} that gravity causes", ("x",)),
    ("inverse_dynamics", "[A]{ydot} - {f} for given {ydot}", ("x", "y")),
    ("forward_dynamics", "{ydot} of [A]{ydot} = {f} + {tau}", ("x", "y", "tau")),
    ("contact_dynamics", "{ydot} where all contacts hold", ("x", "y", "tau")),
    ("coordinate_rates", "{xdot}, Eqs. (9), (45),", ("x", "y")),
    ("point_positions", "{p_P} of each point, Eq. (22),", ("x",)),
    ("point_velocities", "{v_P} of each point, Eq. (27),", ("x", "y")),
    ("point_accelerations", "{a_P} of each point for given {ydot}, Eq. (33),", ("x", "y")),
    ("kinetic_energy", "the kinetic energy", ("x", "y")),
    ("potential_energy", "the potential energy", ("x",)),
    ("momentum", "linear momentum, then angular momentum about the mass centre,", ("x", "y")),
    ("centroidal_momentum_bias", "the rate of the momentum for {ydot} = 0", ("x", "y")),
    ("mass_center", "{p_C}", ("x",)),
)
"""Each output that has derivatives, what it is in a sentence, and the arrays of its variables."""

_NEEDS = {"forward_dynamics": ("mass_matrix", "inverse_dynamics", "forward_dynamics")}
"""Outputs whose programs give the derivatives of an output, where these are more than its own."""


def derivatives_of(outputs: Iterable[Output]) -> tuple[Output, ...]:
    """Return the entries of the outputs that are derivatives of `outputs`.

    The array of one has the axes of the output that is differentiated, and behind them one for the variables.
    """
    entries = {output.name: output for output in outputs}
    return tuple(_derivative(entries, name, of, by) for name, of, by in _DIFFERENTIATED)


def _derivative(entries: Mapping[str, Output], base: str, of: str, by: tuple[str, ...]) -> Output:
    """Return the entry of the derivatives of the output `base`."""
    entry, name = entries[base], f"{base}_derivatives"
    derivation = Derivative(of, _NEEDS.get(base, (base,)), by)
    return Output(
        name,
        lambda system: derivation.array(system, name, entry.array(system)),
        entry.inputs,
        derivation,
        entry.subject,
    )
