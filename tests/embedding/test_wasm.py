"""`--for wasm`: what JavaScript computes in Node.js and in Chromium has the bits of the native library."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.artifacts.wasm import FOLDER
from kanegen.c.folder import write
from kanegen.library import load
from kanegen.products import compiled_files
from tests.support.browser import OpenPage
from tests.support.paths import MODELS
from tests.support.random_trees import everything
from tests.support.wasm import bits, inputs_of, native_results

STATES = 5

DRIVER = """
async function answers(load, { name, inputs, states }) {
  const model = await load({ states, onStatus: "ignore" }), found = [];
  for (const rows of inputs) {
    const result = model[name](...rows);
    const arrays = result instanceof Object && !ArrayBuffer.isView(result) ? Object.values(result) : [result];
    found.push(arrays.map((one) => [...new Uint8Array(one.buffer, one.byteOffset, one.byteLength)]));
  }
  return { found, status: model.status };
}
"""
"""A function of JavaScript that calls a function of a model and returns the bytes of its results."""


def package(system: kg.System, outputs: tuple[str, ...], folder: Path, **options: Any) -> kg.Source:
    """Write a package for a system into a folder, and return the source."""
    source = kg.generate(system, outputs, artifacts=["wasm"], **options)
    write({**source.files, **compiled_files(source, ["wasm"])}, folder)
    return source


class Node:
    """Calls functions of a package in Node.js."""

    def __init__(self, folder: Path, model: str) -> None:
        self._folder, self._model = folder / FOLDER, model

    def __call__(self, query: dict[str, Any]) -> dict[str, Any]:
        script = f"""
            import {{ load }} from "./{self._model}.js";
            {DRIVER}
            console.log(JSON.stringify(await answers(load, {json.dumps(query)})));
        """
        (self._folder / "driver.mjs").write_text(script)
        done = subprocess.run(
            ["node", "driver.mjs"], cwd=self._folder, capture_output=True, text=True, check=True
        )
        answer: dict[str, Any] = json.loads(done.stdout)
        return answer


class Chromium:
    """Calls functions of a package in a page of Chromium, which has no network."""

    def __init__(self, browser: Any, folder: Path, model: str) -> None:
        self._opened, self._model = served(browser, folder / FOLDER), model

    def __call__(self, query: dict[str, Any]) -> dict[str, Any]:
        script = f"""async (query) => {{
            const {{ load }} = await import("/{self._model}.js");
            {DRIVER}
            return answers(load, query);
        }}"""
        answer: dict[str, Any] = self._opened.page.evaluate(script, query)
        return answer


def served(browser: Any, folder: Path) -> OpenPage:
    """Open the page of a folder as if a web server had it."""
    opened = OpenPage(browser)
    opened.page.route(
        "http://model.test/**", lambda route: route.fulfill(path=folder / route.request.url.split("/")[-1])
    )
    opened.page.goto("http://model.test/index.html")
    return opened


def compare(call: Any, source: kg.Source, names: tuple[str, ...]) -> None:
    """Compare functions with the native library, state by state and all states in one call."""
    native = load(source, on_status="ignore")
    for function in source.functions:
        if function.name not in names:
            continue
        inputs = inputs_of(source.system, function, np.float64, STATES)
        rows = [[row.ravel().tolist() for row in state] for state in zip(*inputs.values(), strict=True)]
        expected = native_results(native, function, inputs)
        one_by_one = call({"name": function.name, "inputs": rows})["found"]
        found = np.array([np.frombuffer(bytes(values[0])) for values in one_by_one])
        assert np.array_equal(bits(found), bits(expected.reshape(STATES, -1))), function.name
        flat = [[values.ravel().tolist() for values in inputs.values()]]
        ((together,),) = call({"name": function.name, "inputs": flat, "states": STATES})["found"]
        assert np.array_equal(bits(np.frombuffer(bytes(together))), bits(expected.ravel())), function.name


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, kg.Source]]:
    folder = tmp_path_factory.mktemp("double_pendulum") / "build"
    source = package(kg.load(MODELS / "double_pendulum.toml"), ("forward_dynamics", "step_rk4"), folder)
    yield folder, source


def test_functions_have_the_bits_of_native_code_in_chromium(
    browser: Any, pendulum: tuple[Path, kg.Source]
) -> None:
    folder, source = pendulum
    compare(Chromium(browser, folder, "double_pendulum"), source, ("forward_dynamics",))


@pytest.mark.embed("node")
@pytest.mark.parametrize("name", ["double_pendulum", "panda_arm", "satellite", "gantry_crane"])
def test_functions_have_the_bits_of_native_code_in_node(name: str, tmp_path: Path) -> None:
    outputs = ("mass_matrix", "forward_dynamics", "body_poses", "kinetic_energy")
    source = package(kg.load(MODELS / f"{name}.toml"), outputs, tmp_path / "build")
    compare(Node(tmp_path / "build", name), source, outputs)


@pytest.mark.embed("node")
@pytest.mark.parametrize("seed", range(3))
def test_random_trees_with_all_inputs_have_the_bits_of_native_code_in_node(seed: int, tmp_path: Path) -> None:
    outputs = ("forcing", "forward_dynamics", "coordinate_rates")
    source = package(everything(seed, bodies=3), outputs, tmp_path / "build")
    compare(Node(tmp_path / "build", source.model.name), source, outputs)
