"""The models of the measurements, their kernels and what the C computes for the same states."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from importlib import metadata
from pathlib import Path

import numpy as np

import kanegen as kg
from benchmarks import models
from benchmarks.cuda.nvrtc import compile_cuda
from kanegen.c import Source
from kanegen.reference.states import random_states

ARCHITECTURES = ("sm_80", "sm_90", "compute_80")
"""Cards for which kernels are compiled; the last is assembly that a driver compiles for other cards."""

STATES = 4096
"""States of which the bits are compared with those of the C."""

OUTPUT = "forward_dynamics"


@dataclass(frozen=True)
class Case:
    """A model in one precision.

    Attributes:
        model: Its name.
        precision: "float" or "double".
        output: The output.
    """

    model: str
    precision: str
    output: str = OUTPUT

    @property
    def name(self) -> str:
        """Name of its files."""
        return f"{self.model}_{self.output}_{self.precision}"

    def system(self) -> kg.System:
        """Return the system; a model that is none of the standard ones is a robot with a floating base."""
        if self.model in models.NAMES:
            return models.system(self.model)
        files = [Path(str(one.locate())) for one in metadata.files("example-robot-data") or []]
        (path,) = [one for one in files if one.name == f"{self.model}.urdf"]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", kg.KanegenWarning)
            return replace(kg.load(path, floating_base=True), name=self.model)

    def source(self) -> Source:
        """Return the kernel of the output."""
        return kg.generate(self.system(), [self.output], target="cuda", precision=self.precision)


MEASURED = tuple(Case(model, precision) for model in ("panda", "go2") for precision in ("float", "double"))


def write(folder: Path, cases: tuple[Case, ...] = MEASURED) -> None:
    """Write all that a machine with a card needs: kernels, states, what the C computes, and the script."""
    folder.mkdir(parents=True, exist_ok=True)
    described = []
    for case in cases:
        print(f"prepares {case.name}", flush=True)
        source = case.source()
        for contraction in ("false", "true"):
            for architecture in ARCHITECTURES:
                found = compile_cuda(
                    source.files, f"{source.model.name}.cu", architecture, f"--fmad={contraction}"
                )
                (folder / f"{case.name}_{architecture}_{contraction}.bin").write_bytes(found.binary)
        (folder / f"{case.name}_states.bin").write_bytes(b"".join(_arrays(case, source)))
        block, states = _block(source, case)
        described.append(
            {
                "name": case.name,
                "kernel": f"{source.model.name}_{case.output}_kernel",
                "sizes": [array.size for array in source.functions[-1].inputs],
                "results": source.functions[-1].outputs[0].size,
                "bytes": 4 if case.precision == "float" else 8,
                "block": block,
                "block_states": states,
                "operations": sum(source.operations.values()),
            }
        )
    (folder / "cases.json").write_text(json.dumps({"states": STATES, "cases": described}, indent=1))
    (folder / "card.py").write_text((Path(__file__).parent / "card.py").read_text())


def _arrays(case: Case, source: Source) -> Iterator[bytes]:
    """Yield inputs, then results of the C, each element by element."""
    system = case.system()
    dtype = np.float32 if case.precision == "float" else np.float64
    states = random_states(system, STATES, 1)
    x, y = states.x.astype(dtype), states.y.astype(dtype)
    tau = np.random.default_rng(2).standard_normal(y.shape).astype(dtype)
    library = kg.build(system, [case.output], precision=case.precision, on_status="ignore")
    results = np.asarray(getattr(library, case.output)(x, y, tau))
    arrays = {"x": x, "y": y, "tau": tau}
    for array in source.functions[-1].inputs:
        yield np.ascontiguousarray(arrays[array.name].T).tobytes()
    yield np.ascontiguousarray(results.T).tobytes()


def _block(source: Source, case: Case) -> tuple[int, int]:
    """Return threads and states of a block, as the launch in the source has them."""
    text = source.files[f"{source.model.name}.cu"]
    launch = text[text.index("kanegen_launch(", text.index(f"_{case.output}_batch_cuda(")) :]
    given = [part.strip() for part in launch.split("(", 1)[1].split(",")[1:3]]
    (threads,) = [line.split()[2] for line in text.splitlines() if line.startswith("#define KANEGEN_THREADS")]
    block, states = (int((threads if one == "KANEGEN_THREADS" else one).rstrip("U")) for one in given)
    return block, states
