"""Certified truth: exact results for the floats that are given, and errors and bounds against them.

This subpackage needs the extra `truth` (python-flint), and nothing else imports it. Its two algorithms share
nothing with the derivation that becomes C, nor with each other beyond ball arithmetic and the reading of the
model.
"""

from kanegen.measure.truth.bounds import Fit, bound, fit
from kanegen.measure.truth.calibrate import calibrate
from kanegen.measure.truth.certify import DisagreementError, Truth, truth
from kanegen.measure.truth.conditioning import Conditioning, conditioning
from kanegen.measure.truth.enclosure import Enclosure
from kanegen.measure.truth.errors import StateErrors, errors
from kanegen.measure.truth.measurement import Measurement, measure

__all__ = [
    "Conditioning",
    "DisagreementError",
    "Enclosure",
    "Fit",
    "Measurement",
    "StateErrors",
    "Truth",
    "bound",
    "calibrate",
    "conditioning",
    "errors",
    "fit",
    "measure",
    "truth",
]
