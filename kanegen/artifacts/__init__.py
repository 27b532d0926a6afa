"""Optional files beside generated code, each made for one kind of user.

An artifact is a function from a `Source` to files; `ARTIFACTS` is the list of all. A new artifact is a module
here and an entry in the list; it reads the model from `source.model` and the functions from
`source.functions`. Code that the generated functions need belongs to a target of `kanegen.c`, not here.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from kanegen.artifacts.artifact import Artifact
from kanegen.artifacts.certificate import certificate
from kanegen.artifacts.certificate import refusal as certificate_refusal
from kanegen.artifacts.example import example
from kanegen.artifacts.package_files import cmake, pkg_config, readme
from kanegen.artifacts.reanchoring import reanchoring
from kanegen.artifacts.reanchoring import refusal as reanchoring_refusal
from kanegen.artifacts.selftest import selftest
from kanegen.c.folder import with_provenance
from kanegen.c.source import Source
from kanegen.choices import several
from kanegen.errors import OptionError

__all__ = ["ARTIFACTS", "Artifact", "with_artifacts"]


def _not_in_c(source: Source) -> str:
    return "" if source.target == "c99" else f"it is for C, not for {source.target}"


ARTIFACTS: dict[str, Artifact] = {
    artifact.name: artifact
    for artifact in (
        Artifact("example", "A program that calls every function once.", example, _not_in_c, is_default=True),
        Artifact("cmake", "Builds and installs the code as a library.", cmake, _not_in_c, is_default=True),
        Artifact("pkg-config", "Lets pkg-config find it.", pkg_config, _not_in_c, is_default=True),
        Artifact("readme", "Describes files, arrays and costs.", readme, _not_in_c, is_default=True),
        Artifact("reanchoring", "Re-anchors joints at run time.", reanchoring, reanchoring_refusal),
        Artifact("certificate", "Records how a budget is kept.", certificate, certificate_refusal),
        Artifact("self-test", "Says what a compiler does to IEEE arithmetic.", selftest, _not_in_c),
    )
}
"""Every artifact by its name, in the order of `Source.files`."""


def with_artifacts(source: Source, names: Iterable[str] | str = ()) -> Source:
    """Return `source` with the default artifacts and the artifacts `names` among its files.

    Args:
        source: The code; artifacts that it has already stay or are made anew.
        names: Names of `ARTIFACTS`, or a single one.

    Raises:
        OptionError: If an artifact is unknown, or `source` cannot have it.

    Example:
        >>> with_artifacts(source, ["self-test"]).files["selftest.c"]
    """
    asked = several("artifacts", "artifact", names, ARTIFACTS)
    possible = {name: artifact for name, artifact in ARTIFACTS.items() if not artifact.refusal(source)}
    for name in asked:
        if name not in possible:
            raise OptionError(ARTIFACTS[name].refusal(source))
    files = dict(source.files)
    for name, artifact in possible.items():
        if artifact.is_default or name in asked:
            made = artifact.files(source)
            files |= {file: with_provenance(file, text) for file, text in made.items()}
    return replace(source, files=files, artifacts=tuple(possible))
