"""What the battery asks for and kanegen cannot be asked yet."""

from __future__ import annotations

MISSING = {
    "X9 passage through gimbal lock": "needs simulation, and quaternions or coordinates anchored anew",
    "X10 anchoring coordinates anew": "needs that event",
    "X22 stiff springs and dampers": "needs springs, dampers and simulation",
    "X23 long time": "needs simulation",
    "X24 momentum of a free tree": "needs simulation, or the rate of momentum as an output",
    "X31 self-test of the compiler": "needs that test when a library is built",
    "X33 sanitizers": "the tests of the C run them, but not on the scenes of the battery",
    "X34 fuzzed model files": "needs a nightly run; tests with Hypothesis cover random trees",
    "X35 adversarial search": "needs a nightly run",
    "X36 other rounding modes": "needs a driver that changes them",
    "X37 tiers of more than double precision": "needs those tiers",
    "part of X4, a status for ill-conditioned [A]": "needs an estimate of the error beside the result",
    "part of X7, a status at gimbal lock": "needs the same",
    "part of X8, all of it in angular velocities": "needs other speeds than angle rates",
    "part of X20, trapping exceptions": "needs a run with feenableexcept",
}
"""By number and subject: why."""
