"""`web`, the entry of the package: the page of one system in several precisions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from numpy.typing import ArrayLike

from kanegen.browser.page import METHOD, Competitor, Formulation, Start, WebPage, reference_of
from kanegen.browser.starts import start_of
from kanegen.choices import known_spelling, require_one
from kanegen.errors import ModelError, OptionError, counted, quoted
from kanegen.model.description import require_system
from kanegen.model.system import System
from kanegen.options import TIERS, Progress, Variant, quiet
from kanegen.recursion.outputs.integrators import METHODS
from kanegen.viewer.making import scene_of

STEP = 1e-3
"""Length of a step unless another is given (s)."""

VARIANTS = {
    "double": (TIERS["strict"], "Double precision, with the bits of native code."),
    "float": (TIERS["single"], "Single precision, states as well as arithmetic."),
    "coarse sine": (
        Variant(sincos="polynomial-5"),
        "Double precision with a polynomial of degree 5 for the sine and of degree 6 for the cosine.",
    ),
}
"""The variants of a page by name, each with a sentence."""


def _notes(method: str) -> list[str]:
    """Return the sentences about a page whose motions make steps of a method."""
    shown = METHODS[method].title.rstrip(",")
    reference = (
        "With steps of the same length it shows errors of rounding alone; with shorter steps those of the "
        "method, too."
        if method == METHOD
        else "It makes steps of the classical Runge-Kutta method, so the error is that of rounding and of "
        "the method."
    )
    return [
        "Every motion is computed in this page, by the C that kanegen generates for this model, compiled to "
        f"WebAssembly. All make the same steps of {shown}, without loads and generalized forces beside those "
        "of the model. Joints do not stop at their limits.",
        "The error is the largest angle (rad) or distance (m) between a body and where the reference has it. "
        f"The reference has double-double arithmetic, of about 32 digits. {reference}",
        "Evaluations are those of the generalized accelerations, one state after the other.",
    ]


def web(
    system: System,
    x: ArrayLike | Mapping[str, float] | None = None,
    y: ArrayLike | Mapping[str, float] | None = None,
    *,
    step: float = STEP,
    method: str = METHOD,
    progress: Progress = quiet,
) -> WebPage:
    """Return a page that computes motions of a system in the reader's browser, by the generated C itself.

    The C is compiled to WebAssembly, by clang or by the package ziglang. The page moves the mechanism, has
    sliders for parameters and for the state of the start, and shows double precision, single precision and
    coarse sines side by side, with the error of each beside double-double arithmetic and its evaluations a
    second. It is one file and needs neither a network nor a server.

    Args:
        system: The tree, without prescribed freedoms and contacts.
        x: (m,) coordinates of the start, or some of them by name (rad, m, 1). Without `x` and `y` the joints
            are turned away from their neutral position.
        y: (n,) speeds of the start, or some of them by name (rad/s, m/s); the others are 0.
        step: Length of a step (s).
        method: Name of the method of the steps, such as "implicit_midpoint"; see docs/rollouts.md. The
            reference always makes steps of "rk4".
        progress: Function that is called with the name of each stage.

    Raises:
        OptionError: If `system` is none, has prescribed freedoms or contacts, a name does not exist, the
            system has no such steps, or a number is not finite.
        ArrayError: If `x` or `y` has another number of values.
        SingularError: If [A] is singular in every state.
        BuildError: If there is no compiler for WebAssembly, or it fails.

    Warns:
        KanegenWarning: If a shape of the file of the system cannot be drawn.

    Example:
        kg.web(kg.load("models/double_pendulum.toml"), {"q1": 2.0}).save("double_pendulum.html")
    """
    require_system(system)
    _require_free(system)
    length = _length(step)
    method = known_spelling(method, METHODS)
    require_one("method", method, METHODS)
    scene = scene_of(system)
    start = start_of(system, scene, x, y)
    progress("compiling positions and energies")
    formulation = Formulation.of(system, scene)
    competitors, notes = [], _notes(method)
    for name, (variant, text) in VARIANTS.items():
        progress(f"compiling {name}")
        try:
            found = Competitor.of(name, text, 0, system, variant, method)
        except ModelError as error:
            if variant.precision == "double":
                raise
            notes.append(f"There is no {name}: {error}")
            continue
        if variant.sincos == "shared" or found.module.sines:
            competitors.append(found)
    progress("compiling double-double")
    reference = reference_of(system)
    return WebPage(
        title=system.name,
        subtitle=_subtitle(system),
        formulations=(formulation,),
        competitors=competitors,
        reference=(0, reference),
        substeps=1,
        starts=(Start("", (start,)),),
        start_title="Start",
        pictures=(None,),
        step=length,
        notes=(*notes, *scene.notes),
    )


def _require_free(system: System) -> None:
    """Make sure that the motion of a system follows from its state alone.

    Raises:
        OptionError: If it has prescribed freedoms or contacts.
    """
    if system.prescribed:
        raise OptionError(
            f"system {quoted(system.name)} has prescribed freedoms, such as {system.prescribed_names[0]}. "
            "A page does not know their motion. Lock them, or take kg.simulate and kg.view."
        )
    if system.contacts:
        raise OptionError(
            f"system {quoted(system.name)} has contacts, which steps do not hold. Leave them out by "
            "System.with_contacts([])."
        )


def _length(step: Any) -> float:
    """Return the length of a step as a positive number."""
    is_number = isinstance(step, (int, float)) and not isinstance(step, bool)
    if not is_number or not 0.0 < step < math.inf:
        raise OptionError(f"step: {quoted(step)} is no positive number of seconds.")
    return float(step)


def _subtitle(system: System) -> str:
    """Return how many bodies, freedoms and parameters there are."""
    parts = [counted(len(system.bodies), "body", "bodies"), counted(len(system.freedoms), "freedom")]
    if system.parameters:
        parts.append(counted(len(system.parameters), "parameter"))
    return " · ".join(parts)
