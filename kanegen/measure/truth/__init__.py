"""Certified truth: exact results for the very floats of a state, and errors and bounds against them.

- `certify` runs two algorithms, `kane` and `newton_euler`, in ball arithmetic (`balls`) and doubles the
  working precision until both `enclosure`s are narrow. Both read the model through `tree`, and only that.
- `certified_derivatives` does the same for derivatives, by differences with a proven remainder.
- `errors` compares results with exact ones; `conditioning` says how much accuracy the problem costs every
  program; `bounds` combines both into bounds on the errors of generated code.
- `measurement` does all of this for a compiled library, and `calibration` fits the bounds to libraries.

The package needs the extra `truth` (python-flint). Exact results share nothing with the derivations that
become C, nor with the NumPy reference; the two algorithms share nothing with each other beyond ball
arithmetic and the reading of the model. Only conditioning and bounds use magnitudes of the reference.
"""

from kanegen.measure.truth.bounds import Fit, bound, fit
from kanegen.measure.truth.calibration import calibrate
from kanegen.measure.truth.certified_derivatives import derivatives
from kanegen.measure.truth.certify import DisagreementError, Truth, truth
from kanegen.measure.truth.conditioning import Conditioning, conditioning
from kanegen.measure.truth.enclosure import Enclosure
from kanegen.measure.truth.errors import StateErrors, errors
from kanegen.measure.truth.measurement import ExactState, Measurement, measure

__all__ = [
    "Conditioning",
    "DisagreementError",
    "Enclosure",
    "ExactState",
    "Fit",
    "Measurement",
    "StateErrors",
    "Truth",
    "bound",
    "calibrate",
    "conditioning",
    "derivatives",
    "errors",
    "fit",
    "measure",
    "truth",
]
