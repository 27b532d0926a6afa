"""JavaScript: calls of the code in WebAssembly from Node.js, with arguments and with numbers in place."""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

import kanegen as kg
from benchmarks.embedding.alone import in_c
from benchmarks.embedding.answering import Turns, answering
from benchmarks.embedding.row import SECONDS, Row, in_turns
from kanegen.artifacts.wasm import FOLDER
from kanegen.c.folder import write
from kanegen.errors import MissingError
from kanegen.products import compiled_files

CALLS = {
    "WebAssembly without its module of JavaScript": "bare",
    "numbers in place": "in_place",
    "arguments copied": "arguments",
}
"""Calls by their description."""

SCRIPT = """\
import {{ readFile }} from "node:fs/promises";
import {{ createInterface }} from "node:readline";
import {{ load }} from "./{model}.js";

const model = await load(), inputs = {inputs};
const {{ instance }} = await WebAssembly.instantiate(await readFile("./{model}.wasm"));
const {{ memory, __heap_base: base, {model}_{name}: bare }} = instance.exports;
const addresses = [0, 1, 2, 3].map((place) => base.value + 64 * place);
addresses.slice(0, 3).forEach((address, k) => new Float64Array(memory.buffer, address, 7).set(inputs[k]));
const calls = {{
  bare: () => bare(...addresses),
  arguments: () => model.{name}(...inputs),
  in_place: () => model.{name}(),
}};
for await (const line of createInterface(process.stdin)) {{
  for (let count = 1; ; count *= 2) {{
    const start = performance.now();
    for (let i = 0; i < count; i++) calls[line]();
    const taken = performance.now() - start;
    if (taken >= {milliseconds}) {{
      console.log((1e6 * taken) / count);
      break;
    }}
  }}
}}
"""
"""Answers the name of a call, a line each, with nanoseconds of one."""


def measure() -> list[Row]:
    """Measure accelerations of panda_arm.

    Raises:
        MissingError: If Node.js is not installed.
    """
    node = shutil.which("node")
    if node is None:
        raise MissingError("Node.js is not installed (apt-get install nodejs)")
    name = "forward_dynamics"
    source = kg.generate(kg.load("models/panda_arm.toml"), (name,), artifacts=["wasm"])
    rng = np.random.default_rng(1)
    inputs = {one: rng.uniform(-1, 1, 7) for one in ("x", "y", "tau")}
    version = subprocess.run([node, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    what = f"{name} of panda_arm"
    alone = in_c(source, name, inputs)
    with _turns(node, source, name, list(inputs.values())) as turn:
        return [
            Row("JavaScript", f"{how}, {what}", *in_turns(alone, turn(call)), f"Node.js {version}")
            for how, call in CALLS.items()
        ]


@contextmanager
def _turns(node: str, source: kg.Source, name: str, inputs: list[np.ndarray]) -> Iterator[Turns]:
    """Run a script in Node.js, and yield its turns."""
    text = SCRIPT.format(
        model=source.model.name,
        name=name,
        inputs=json.dumps([one.tolist() for one in inputs]),
        milliseconds=1e3 * SECONDS,
    )
    with tempfile.TemporaryDirectory() as folder:
        write({**source.files, **compiled_files(source, ["wasm"])}, Path(folder) / "code")
        package = Path(folder, "code", FOLDER)
        (package / "turns.mjs").write_text(text, encoding="utf-8")
        with answering([node, "turns.mjs"], package) as turns:
            yield turns
