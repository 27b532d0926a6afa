"""Optional files beside generated code, each made for one kind of user.

An artifact is a function from a `Source` to files; `ARTIFACTS` is the list of all. A new artifact is a module
here and an entry in the list; it reads the model from `source.model` and the functions from
`source.functions`, and says which outputs it calls, so that `generate` adds them. Code that the generated
functions need belongs to a target of `kanegen.c`, not here.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from kanegen.artifacts import fmi
from kanegen.artifacts.arduino import arduino
from kanegen.artifacts.arduino import refusal as arduino_refusal
from kanegen.artifacts.artifact import ELEMENTS, WHOLE, Artifact, lacking, motion
from kanegen.artifacts.casadi import casadi, usual_outputs
from kanegen.artifacts.casadi import refusal as casadi_refusal
from kanegen.artifacts.certificate import certificate
from kanegen.artifacts.certificate import refusal as certificate_refusal
from kanegen.artifacts.cpp import cpp
from kanegen.artifacts.description import description
from kanegen.artifacts.example import example
from kanegen.artifacts.octave import octave
from kanegen.artifacts.octave import refusal as octave_refusal
from kanegen.artifacts.package_files import cmake, pkg_config, readme
from kanegen.artifacts.reanchoring import reanchoring
from kanegen.artifacts.reanchoring import refusal as reanchoring_refusal
from kanegen.artifacts.rust import refusal as rust_refusal
from kanegen.artifacts.rust import rust
from kanegen.artifacts.selftest import selftest
from kanegen.artifacts.simulink import refusal as simulink_refusal
from kanegen.artifacts.simulink import simulink
from kanegen.artifacts.wasm import refusal as wasm_refusal
from kanegen.artifacts.wasm import wasm
from kanegen.c.provenance import with_provenance
from kanegen.c.source import Source
from kanegen.choices import several
from kanegen.errors import OptionError
from kanegen.model.system import System
from kanegen.options import STRICT, Variant
from kanegen.recursion.outputs import EQUATIONS, INTEGRATORS, OUTPUTS

__all__ = [
    "ARTIFACTS",
    "Artifact",
    "chosen",
    "outputs_with",
    "places",
    "require_language",
    "variant_with",
    "with_artifacts",
]


ARTIFACTS: dict[str, Artifact] = {
    artifact.name: artifact
    for artifact in (
        Artifact(
            "example",
            "A program that calls every function once.",
            example,
            is_default=True,
            places=("main.c",),
        ),
        Artifact(
            "cmake",
            "Builds and installs the code as a library.",
            cmake,
            is_default=True,
            places=("CMakeLists.txt",),
        ),
        Artifact("pkg-config", "Lets pkg-config find it.", pkg_config, is_default=True),
        Artifact(
            "readme",
            "Describes files, arrays and costs.",
            readme,
            is_default=True,
            languages=("c99", "cuda"),
            places=("README.md",),
        ),
        Artifact(
            "description",
            "Names the elements of arrays, and tells of them.",
            description,
            next_step="Include `{model}_description.h`; `{model}_describe()` returns names, units and "
            "limits as JSON",
            page="docs/embedding/description.md",
        ),
        Artifact(
            "cpp",
            "A class in C++17, in headers alone.",
            cpp,
            usual_outputs=motion,
            next_step="Include `{model}.hpp` and compile `{model}.c` as C; the methods of "
            "`kanegen::{model}::model` are the functions",
            page="docs/embedding/cpp.md",
        ),
        Artifact(
            "reanchoring",
            "Re-anchors joints at run time.",
            reanchoring,
            reanchoring_refusal,
            languages=("c99", "cuda"),
            precision="double",
        ),
        Artifact("certificate", "Records how a budget is kept.", certificate, certificate_refusal),
        Artifact(
            "arduino",
            "A library for microcontrollers.",
            arduino,
            arduino_refusal,
            precision="float",
            usual_outputs=motion,
            next_step="Copy `arduino/{model}` into the folder of libraries of Arduino, PlatformIO, Zephyr "
            "or ESP-IDF",
            page="docs/embedding/microcontrollers.md",
            places=("arduino",),
        ),
        Artifact(
            "casadi",
            "External functions of CasADi, with Jacobians.",
            casadi,
            casadi_refusal,
            precision="double",
            usual_outputs=usual_outputs,
            next_step="Compile the C to a shared library, and load functions by `casadi.external`; "
            "`{model}_casadi.c` lists them",
            page="docs/embedding/casadi.md",
            takes=WHOLE,
        ),
        Artifact(
            "octave",
            "A mex file for MATLAB and Octave, and a package of functions.",
            octave,
            octave_refusal,
            usual_outputs=motion,
            next_step="Call `{model}.build()` in MATLAB or Octave in this folder; each function has help",
            page="docs/embedding/octave.md",
            places=("+{model}",),
            takes=ELEMENTS,
        ),
        Artifact(
            "rust",
            "A crate of Rust, without the standard library.",
            rust,
            rust_refusal,
            usual_outputs=motion,
            next_step="Add the crate to a package: `cargo add --path`, with the path of the folder `rust`",
            page="docs/embedding/rust.md",
            places=("rust",),
        ),
        Artifact(
            "fmi2",
            "Sources of an FMU for FMI 2.0.",
            fmi.fmi2,
            fmi.refusal,
            outputs=fmi.needed_outputs,
            precision="double",
            usual_outputs=fmi.usual_outputs,
            next_step="Import `{model}_fmi2.fmu`, which `kanegen generate --for fmi2` compiles of the "
            "sources in `fmi2`",
            page="docs/embedding/fmi.md",
            places=("fmi2",),
            takes=ELEMENTS,
        ),
        Artifact(
            "fmi3",
            "Sources of an FMU for FMI 3.0.",
            fmi.fmi3,
            fmi.refusal,
            outputs=fmi.needed_outputs,
            precision="double",
            usual_outputs=fmi.usual_outputs,
            next_step="Import `{model}_fmi3.fmu`, which `kanegen generate --for fmi3` compiles of the "
            "sources in `fmi3`",
            page="docs/embedding/fmi.md",
            places=("fmi3",),
            takes=ELEMENTS,
        ),
        Artifact(
            "self-test",
            "Says what a compiler does to IEEE arithmetic.",
            selftest,
            places=("selftest.c",),
        ),
        Artifact(
            "simulink",
            "Functions with fixed sizes for the block C Caller.",
            simulink,
            simulink_refusal,
            usual_outputs=motion,
            next_step="Set up the block C Caller as `{model}_simulink.md` says",
            page="docs/embedding/simulink.md",
            takes=ELEMENTS,
        ),
        Artifact(
            "wasm",
            "A package for browsers and Node.js, with types.",
            wasm,
            wasm_refusal,
            usual_outputs=motion,
            next_step="Add the package by `npm install`, with the path of the folder `wasm`; "
            "`wasm/README.md` calls it",
            page="docs/embedding/webassembly.md",
            places=("wasm",),
        ),
    )
}
"""Every artifact by its name, in the order of `Source.files`."""


def chosen(names: Iterable[str] | str) -> tuple[str, ...]:
    """Return the names of artifacts that a user chose, checked, each once, in the order of `ARTIFACTS`.

    Raises:
        OptionError: If an artifact is unknown, or `names` holds no names.
    """
    return several("artifacts", "artifact", names, ARTIFACTS)


def require_language(artifacts: Iterable[str], language: str) -> None:
    """Make sure that artifacts can stand beside code in a language.

    Args:
        artifacts: Names of artifacts, checked.
        language: Name of the target, such as "cuda".

    Raises:
        OptionError: If one cannot.
    """
    for name in artifacts:
        if why := ARTIFACTS[name].refusal_of_language(language):
            raise OptionError(f"{name}: {why}")


def outputs_with(
    artifacts: Iterable[str], system: System, outputs: Iterable[str] | str | None = None
) -> tuple[str, ...]:
    """Return the outputs to generate for artifacts: the user's, or else the usual ones and those they call.

    Args:
        artifacts: Names of artifacts, checked.
        system: The tree.
        outputs: The outputs that the user names, None for none.

    Raises:
        OptionError: If an artifact calls an output that the user's outputs lack, or one of these is unknown.

    Example:
        >>> outputs_with(["casadi"], system)
        ('mass_matrix', 'forcing', 'forward_dynamics', 'forward_dynamics_derivatives')
    """
    if outputs is None:
        added = (output for name in artifacts for output in ARTIFACTS[name].added_outputs(system))
        return tuple(dict.fromkeys((*EQUATIONS, *added)))
    needed = {name: ARTIFACTS[name].needed_outputs(system) for name in artifacts}
    asked = several("outputs", "output", outputs, (*OUTPUTS, *INTEGRATORS))
    for name, called in needed.items():
        if missing := lacking([output for output in called if output not in asked]):
            raise OptionError(f"{name}: {missing}")
    return asked


def variant_with(artifacts: Iterable[str], variant: Variant = STRICT, *, precision: str | None) -> Variant:
    """Return a variant with the precision that artifacts take where the user names none.

    Args:
        artifacts: Names of artifacts, checked.
        variant: The choices of the user.
        precision: The precision that the user names, None for none. A variant whose precision is not double
            names one, too.

    Raises:
        OptionError: If two artifacts take different precisions.
    """
    taken = {ARTIFACTS[name].precision: name for name in artifacts if ARTIFACTS[name].precision}
    if precision is not None or variant.precision != STRICT.precision or not taken:
        return variant
    if len(taken) > 1:
        words = " and ".join(f"{name} takes {one}" for one, name in taken.items())
        raise OptionError(
            f"{words}, and one folder holds one precision. Give --precision, or generate them one by one."
        )
    return replace(variant, precision=next(iter(taken)))


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
    asked = chosen(names)
    obstacles = {name: artifact.obstacle(source) for name, artifact in ARTIFACTS.items()}
    for name in asked:
        if obstacles[name]:
            raise OptionError(f"{name}: {obstacles[name]}")
    possible = tuple(name for name in ARTIFACTS if not obstacles[name])
    made: dict[str, dict[str, str]] = {}
    for name in asked:
        made[name] = _files(name, source)
    purposes = {ARTIFACTS[name].summary: tuple(files) for name, files in made.items()}
    steps = {name: _next_step(ARTIFACTS[name], source) for name in asked if ARTIFACTS[name].next_step}
    beside, next_steps = {**source.beside, **purposes}, {**source.next_steps, **steps}  # for the README
    source = replace(source, artifacts=possible, beside=beside, next_steps=next_steps)
    for name in possible:
        if ARTIFACTS[name].is_default and name not in made:
            made[name] = _files(name, source)
    files = dict(source.files)
    for name in ARTIFACTS:
        files |= made.get(name, {})
    return replace(source, files=files, places=places(source.model.name))


def places(model: str) -> tuple[str, ...]:
    """Return the names of files and folders of all artifacts of a model that do not begin with its name."""
    return tuple(place.format(model=model) for artifact in ARTIFACTS.values() for place in artifact.places)


def _next_step(artifact: Artifact, source: Source) -> str:
    """Return what users do next with the files of an artifact, and where that is documented."""
    done = artifact.next_step.replace("{model}", source.model.name)
    return f"{done} (`{artifact.page}` of kanegen)"


def _files(name: str, source: Source) -> dict[str, str]:
    """Return the files of an artifact beside a source, each with its line of provenance."""
    made = ARTIFACTS[name].files(source)
    return {file: with_provenance(file, text) for file, text in made.items()}
