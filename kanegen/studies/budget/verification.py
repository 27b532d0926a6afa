"""Whether a certificate still holds: everything in it but the times is made and measured anew.

What was edited, or belongs to another model or version, is an error. What can be compared but differs is a
finding that does not hold.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

from kanegen.compiler import Progress, quiet
from kanegen.errors import BuildError, CertificateError, KanegenError
from kanegen.library import load
from kanegen.model.system import System
from kanegen.readers import load as load_model
from kanegen.studies.budget.certificate import read
from kanegen.studies.budget.certificate_fields import evidence
from kanegen.studies.budget.checks import Checks, Finding
from kanegen.studies.budget.fingerprint import model_text
from kanegen.studies.budget.region import region
from kanegen.studies.budget.workbench import is_reproducible
from kanegen.studies.tradeoff.built import generated


@dataclass(frozen=True)
class Verification:
    """What became of a certificate."""

    findings: tuple[Finding, ...]

    @property
    def passed(self) -> bool:
        """Whether nothing that was looked at has failed."""
        return all(finding.holds is not False for finding in self.findings)


def verify(
    path: Path,
    model: System | None = None,
    states: int | None = None,
    seed: int = 1,
    progress: Progress = quiet,
) -> Verification:
    """Make and measure anew what a certificate says.

    Args:
        path: The certificate; C that lies beside it is looked at as well.
        model: What it should be of; by default the model that it holds is believed.
        states: Fresh ones; by default as many as it was validated by.
        seed: Of the fresh states.
        progress: Told the name of each stage.

    Raises:
        BuildError: If there is no C compiler, or it fails.
        CertificateError: If the file is no certificate, was edited, or is of another model or version.
        ReadError: If it cannot be read.
    """
    certificate = read(path)
    progress("generating and building")
    try:
        said = evidence(certificate)
        if model is not None and model_text(model) != said.model_text:
            raise CertificateError(f"of another model than {model.name!r} as it is now. Generate it anew.")
        box = region(_model(said.model_text), said.domain)
        library = load(generated(box.system, certificate.candidate))
    except BuildError:
        raise
    except KanegenError as error:
        raise CertificateError(f"{path}: {error}") from None
    checks = Checks(path.parent, said, box, library, is_reproducible(certificate.candidate))
    progress("exact results in fresh states")
    return Verification(tuple(checks.findings(states or said.states, seed)))


def _model(text: str) -> System:
    """The system in the text of a model file."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.toml"
        file.write_text(text, encoding="utf-8")
        return load_model(file)
