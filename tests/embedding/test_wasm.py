"""`--for wasm`: what JavaScript computes in Node.js and in Chromium has the bits of the native library."""

from __future__ import annotations

import json
import shutil
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
from tests.support.pages import blocks, copy_of_checkout, files, run, run_console
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

    def answer(route: Any) -> None:
        path = folder / route.request.url.split("/")[-1]
        if path.is_file():
            route.fulfill(path=path)
        else:
            route.fulfill(status=404)

    opened.page.route("http://model.test/**", answer)
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


TYPED = """
import { load, description, StatusError, type Model, type Arrays } from "./double_pendulum.js";

const seen: string[] = [];
const model: Model = await load({ states: 2, onStatus: (error: StatusError) => seen.push(error.message) });
const ydot: Float64Array = model.forward_dynamics([0.1, 0.2], new Float64Array(2), undefined);
const { x_next, y_next } = model.step_rk4([0.1, 0.2], [0, 0], [0, 0], 1e-3);
const arrays: Arrays = model.arrays;
const name: string = description.freedoms[0].name;
arrays.x.set([ydot[0], x_next[0], y_next[0], name.length]);
model.prepare(description.parameters.map((one) => one.default));
// @ts-expect-error: there is no such function
model.inverse_dynamics();
// @ts-expect-error: there is no such rule
await load({ onStatus: "panic" });
// @ts-expect-error: arrays stay where they are
arrays.x = new Float64Array(2);
"""
"""A program in TypeScript that uses everything that the types describe."""


@pytest.mark.embed("node", "npm")
def test_types_describe_what_the_module_does(pendulum: tuple[Path, kg.Source], tmp_path: Path) -> None:
    folder = shutil.copytree(pendulum[0] / FOLDER, tmp_path / "package")
    (folder / "use.mts").write_text(TYPED.replace("./double_pendulum.js", "double_pendulum"))
    run("npm install --silent --no-audit --no-fund --prefix . typescript@^7", tmp_path)
    options = "--noEmit --strict --module nodenext --target es2022 --lib es2022,dom --types ''"
    run(f"../node_modules/.bin/tsc {options} use.mts", folder)


STATUSES = """async ([parameters, x]) => {
    const { load } = await import("/double_pendulum.js");
    const model = await load(), seen = [], none = [0, 0];
    const tried = (call) => {
        try {
            call();
            seen.push(null);
        } catch ({ name, message, kind }) {
            seen.push([name, message, kind]);
        }
    };
    tried(() => model.prepare(parameters));
    tried(() => model.forward_dynamics(x, none, none));
    tried(() => model.forward_dynamics(x, none));
    tried(() => model.forward_dynamics([1], none));
    const several = await load({ states: 3, onStatus: ({ message }) => seen.push(message) });
    several.prepare(parameters);
    several.forward_dynamics([...x, ...x, ...x], none, none);
    return seen;
}"""
"""Calls that fail, one after the other, and what each throws or reports."""


def test_statuses_have_the_words_of_the_library(browser: Any, pendulum: tuple[Path, kg.Source]) -> None:
    folder, source = pendulum
    opened = served(browser, folder / FOLDER)
    parameters = [9.81, 1.0, 1.0, 0.0, 0.7]  # a lower body without mass, by whose inertia `prepare` divides
    prepared, singular, again, shape, *several = opened.page.evaluate(STATUSES, [parameters, [0.1, 0.2]])
    assert prepared is None and opened.messages == ["prepare: a result is infinite or NaN."]
    library = load(source, on_status="ignore").with_parameters({"m2": 0.0}).with_on_status("warn")
    with pytest.raises(kg.KanegenError) as error:
        library.forward_dynamics([0.1, 0.2], [0, 0], [0, 0])
    clause = "forward_dynamics: the pivot of [A] at freedom 'q2'"
    assert singular[1].startswith(clause) and str(error.value).startswith(clause)
    assert singular[::2] == ["StatusError", "missing"] == again[::2]
    assert shape[:2] == ["RangeError", "forward_dynamics: x has 1 numbers instead of 2."]
    assert several == [
        "prepare: a result is infinite or NaN.",
        "forward_dynamics: 3 of 3 states have a result that is missing, not finite or not accurate.",
    ]


NO_NUMBERS = {
    "[null, 0]": "TypeError: forward_dynamics: x[0] is null instead of a number.",
    "[0, undefined]": "TypeError: forward_dynamics: x[1] is undefined instead of a number.",
    "[, 0]": "TypeError: forward_dynamics: x[0] is undefined instead of a number.",
    "[0, '1']": "TypeError: forward_dynamics: x[1] is a string instead of a number.",
    "[true, 0]": "TypeError: forward_dynamics: x[0] is a boolean instead of a number.",
    "[1n, 0]": "TypeError: forward_dynamics: x[0] is a bigint instead of a number.",
    "[Symbol(), 0]": "TypeError: forward_dynamics: x[0] is a symbol instead of a number.",
    "[[1], [2]]": "TypeError: forward_dynamics: x[0] is an array instead of a number.",
    "[new Date(0), 0]": "TypeError: forward_dynamics: x[0] is an object instead of a number.",
    "new BigInt64Array(2)": "TypeError: forward_dynamics: x[0] is a bigint instead of a number.",
    "{ length: 2 }": "TypeError: forward_dynamics: x[0] is undefined instead of a number.",
    "'12'": "TypeError: forward_dynamics: x is a string instead of an array of numbers.",
    "null": "TypeError: forward_dynamics: x is null instead of an array of numbers.",
    "new Set([1, 2])": "TypeError: forward_dynamics: x is an object instead of an array of numbers.",
    "new DataView(new ArrayBuffer(2))": (
        "TypeError: forward_dynamics: x is an object instead of an array of numbers."
    ),
    "1": "RangeError: forward_dynamics: x has 1 numbers instead of 2.",
}
"""Arguments that hold no numbers, in JavaScript, and the errors in which they end."""

OTHER_CALLS = {
    "load({ state: 2 })": "TypeError: load: there is no option 'state', but wasm, states and onStatus.",
    "load(5)": "TypeError: load: a number is no object of options, such as { states: 100 }.",
    "load(null)": "TypeError: load: null is no object of options, such as { states: 100 }.",
    "model.forward_dynamics([1, 2], [0, 0], [0, 0], [0])": (
        "TypeError: forward_dynamics: 4 arguments were given, and it takes 3."
    ),
    "model.prepare([1, 2, 3, 4, '5'])": "TypeError: prepare: parameters[4] is a string instead of a number.",
    "model.step_rk4([1, 2])": "RangeError: step_rk4: give step, a finite length in s; it is NaN.",
    "model.step_rk4([1, 2], [0, 0], [0, 0], Infinity)": (
        "RangeError: step_rk4: give step, a finite length in s; it is Infinity."
    ),
    "model.step_rk4([1, 2], [0, 0], [0, 0], null)": (
        "TypeError: step_rk4: step is null instead of an array of numbers."
    ),
    "[...model.forward_dynamics(new Float32Array(2), { 0: 0, 1: 0, length: 2 }, new Uint8Array(2))]": "0,0",
    "[...model.step_rk4([0, 0], [0, 0], [0, 0], 0.1).x_next, ...model.step_rk4().y_next]": "0,0,0,0",
}
"""Further calls, in JavaScript, and their errors or results."""


def test_what_is_no_number_is_refused(browser: Any, pendulum: tuple[Path, kg.Source]) -> None:
    opened = served(browser, pendulum[0] / FOLDER)
    calls = {f"model.forward_dynamics({one}, [0, 0], [0, 0])": error for one, error in NO_NUMBERS.items()}
    calls |= OTHER_CALLS
    script = f"""async () => {{
        const {{ load }} = await import("/double_pendulum.js"), model = await load();
        const answers = [];
        for (const call of [{", ".join(f"() => {call}" for call in calls)}]) {{
            try {{
                answers.push(String(await call()));
            }} catch (error) {{
                answers.push(String(error));
            }}
        }}
        return answers;
    }}"""
    assert dict(zip(calls, opened.page.evaluate(script), strict=True)) == calls


def test_the_page_follows_its_fields(browser: Any, pendulum: tuple[Path, kg.Source]) -> None:
    folder, source = pendulum
    opened = served(browser, folder / FOLDER)
    opened.page.wait_for_selector("#results td")
    opened.page.fill("input[name=x0]", "1.5")
    shown = [float(text) for text in opened.page.locator("#results td").all_inner_texts()]
    expected = load(source).forward_dynamics([1.5, 0.2], [0.1, 0.2], [0, 0])
    assert np.allclose(shown, expected, rtol=1e-5)  # six digits are shown
    picture = "document.querySelector('canvas').getContext('2d').getImageData(60, 20, 200, 200).data"
    assert opened.page.evaluate(f"{picture}.some((n) => n)")
    opened.page.fill("input[name=parameters3]", "0")
    assert "forward_dynamics: status 2" in opened.page.inner_text("#results")
    assert opened.messages == []


def test_code_without_batches_has_one_state(browser: Any, tmp_path: Path) -> None:
    package(kg.load(MODELS / "planar_pendulum.toml"), ("forcing",), tmp_path / "build", batches=False)
    opened = served(browser, tmp_path / "build" / FOLDER)
    script = """import("/planar_pendulum.js")
        .then(({ load }) => load({ states: 2 }))
        .catch(({ message }) => message)"""
    assert opened.page.evaluate(script) == "states: this code has no functions for several states at once."


def test_floats_are_arrays_of_floats(browser: Any, tmp_path: Path) -> None:
    system = kg.load(MODELS / "planar_pendulum.toml")
    source = package(system, ("forcing",), tmp_path / "build", precision="float")
    opened = served(browser, tmp_path / "build" / FOLDER)
    script = """async () => {
        const { load } = await import("/planar_pendulum.js");
        const model = await load(), f = model.forcing([0.1, 0.2], [0.3, 0.4]);
        return [f.constructor.name, [...f]];
    }"""
    kind, found = opened.page.evaluate(script)
    assert kind == "Float32Array"
    expected = load(source).forcing([0.1, 0.2], [0.3, 0.4])
    assert np.array_equal(np.array(found, np.float32), expected)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("{ states: 0 }", "states: 0 is no positive whole number."),
        ("{ states: 1e12 }", "states: 1000000000000 states need "),
        ("{ onStatus: 'panic' }", 'onStatus: give "warn", "raise", "ignore" or a function'),
        ("{ wasm: 'missing.wasm' }", "http://model.test/missing.wasm: 404"),
    ],
    ids=["no states", "too many states", "unknown rule", "missing module"],
)
def test_wrong_options_end_in_one_line(
    options: str, message: str, browser: Any, pendulum: tuple[Path, kg.Source]
) -> None:
    opened = served(browser, pendulum[0] / FOLDER)
    script = f"""import("/double_pendulum.js")
        .then(({{ load }}) => load({options}))
        .catch(({{ message }}) => message)"""
    found = opened.page.evaluate(script)
    assert found.startswith(message) and "\n" not in found


def test_each_state_may_have_its_own_parameters(browser: Any, tmp_path: Path) -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    source = package(system, ("forcing",), tmp_path / "build", parameters_by_state=True)
    opened = served(browser, tmp_path / "build" / FOLDER)
    script = """async (parameters) => {
        const { load } = await import("/double_pendulum.js");
        const model = await load({ states: 2 });
        model.prepare(parameters);
        return [...model.forcing([0.1, 0.2], [0.3, 0.4])];
    }"""
    parameters = [[9.81, 1.0, 1.0, 0.5, 0.7], [1.62, 2.0, 0.8, 0.7, 0.4]]
    found = np.reshape(opened.page.evaluate(script, np.ravel(parameters).tolist()), (2, 2))
    names = load(source).parameter_names
    for row, values in zip(found, parameters, strict=True):
        one = load(source).with_parameters(dict(zip(names, values, strict=True)))
        assert np.array_equal(row, one.forcing([0.1, 0.2], [0.3, 0.4]))


PAGE = "embedding/webassembly"


@pytest.mark.embed("node")
def test_the_page_does_what_it_says(tmp_path: Path) -> None:
    folder = copy_of_checkout(tmp_path)
    for name, text in files(PAGE).items():
        (folder / name).write_text(text)
    for text in blocks(PAGE, "console"):
        run_console(text, folder)
