"""Pages in Chromium: the bits of native code, the reference, what readers do, and what is refused."""

import base64
import subprocess
import sys
from fractions import Fraction

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen import files
from kanegen.browser.web import VARIANTS
from kanegen.errors import ArrayError, OptionError, WriteError
from kanegen.library import load
from kanegen.program.precision import precision_named
from kanegen.reference.states import random_states
from tests.support.browser import NARROW, WIDE, OpenPage
from tests.support.paths import ROOT
from tests.support.prescribed_trees import KINDS, tree
from tests.support.random_trees import everything
from tests.support.robots import robot_file

STATES = 1000
LARGEST = 3_000_000
"""Bytes of a page without meshes."""

EVALUATE = """([place, rows]) => {
  const { arrays, calls } = kanegenWeb.shown.competitors[place].evaluator;
  const found = { acceleration: [], x_next: [], y_next: [], xdot: [] };
  for (const row of rows) {
    for (const [name, values] of Object.entries(row)) arrays[name].set(values);
    calls.forward_dynamics();
    calls.step_rk4();
    for (const [name, kept] of Object.entries(found)) if (arrays[name]) kept.push(...arrays[name]);
  }
  arrays.tau.fill(0);
  const encode = (numbers, Type) => btoa(String.fromCharCode(...new Uint8Array(Type.from(numbers).buffer)));
  const inParts = (numbers, Type) => {
    const parts = [];
    for (let i = 0; i < numbers.length; i += 4096) parts.push(encode(numbers.slice(i, i + 4096), Type));
    return parts;
  };
  const Type = arrays.x.constructor;
  return Object.fromEntries(Object.entries(found).map(([name, kept]) => [name, inParts(kept, Type)]));
}"""
"""Accelerations and steps of many states by a competitor, in base64."""


def model(name):
    return kg.load(ROOT / "models" / f"{name}.toml")


GRAVITY, LENGTH = 8.0, 0.5


def simple_pendulum(name="pendulum"):
    """A point mass that hangs along axis 1 and turns about axis 3."""
    free, inertia = np.array([[False, False, True, False, False, False]]), np.zeros((1, 3, 3))
    position, gravity = [[LENGTH, 0, 0]], (GRAVITY, 0, 0)
    return kg.System.from_arrays(
        [0], [2.0], inertia, position, np.zeros((1, 3)), free=free, gravity=gravity, name=name
    )


def rates_of_a_pendulum(state):
    return mpmath.matrix([state[1], -mpmath.mpf(GRAVITY) / LENGTH * mpmath.sin(state[0])])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("pages")


def opened(browser, folder, page, size=WIDE, play=False):
    file = folder / f"{len(list(folder.iterdir()))}.html"
    page.save(file, play=play)
    return OpenPage(browser, size).open(file)


@pytest.fixture(scope="module")
def pendulum(browser, folder):
    found = opened(browser, folder, kg.web(model("double_pendulum"), {"q1": 2.0, "q2": 1.5}))
    yield found
    assert found.messages == []
    assert found.requests == []
    found.close()


def ask(pendulum, script, argument=None):
    return pendulum.page.evaluate(f"(argument) => {{ const page = kanegenWeb.shown; {script} }}", argument)


def wait(pendulum, condition):
    pendulum.page.wait_for_function(f"() => {{ const page = kanegenWeb.shown; return {condition}; }}")


def numbers(parts, dtype):
    return np.frombuffer(b"".join(map(base64.b64decode, parts)), dtype)


def require_bits_of_native_code(page, system, place, name):
    """Compare a competitor of a page that is open with the native library of the same variant."""
    variant, _ = VARIANTS[name]
    library = load(kg.generate(system, ("step_rk4",), tier=variant), on_status="ignore")
    dtype = precision_named(library.storage).dtype
    states, rng = random_states(system, STATES, 3), np.random.default_rng(4)
    x, y = states.x.astype(dtype), states.y.astype(dtype)
    tau = rng.standard_normal(y.shape).astype(dtype)
    rows = [
        {"x": a.tolist(), "y": b.tolist(), "tau": c.tolist(), "step": [1e-3]}
        for a, b, c in zip(x, y, tau, strict=True)
    ]
    found = page.page.evaluate(EVALUATE, [place, rows])
    expected = library.forward_dynamics(x, y, tau)
    following = library.step(x, y, tau, step=1e-3)
    for key, values in (("acceleration", expected), ("x_next", following[0]), ("y_next", following[1])):
        ours = numbers(found[key], dtype).reshape(values.shape)
        same = (ours.view(np.uint8) == np.ascontiguousarray(values).view(np.uint8)).all()
        assert same or np.array_equal(ours, values, equal_nan=True), (name, key)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["implicit_midpoint", "linearly_implicit"])
def test_other_methods_have_the_bits_of_native_rollouts(browser, folder, method):
    """Twenty steps of 10 ms; a step of 3 s of the implicit midpoint rule says that it is too long."""
    system, x, y = model("double_pendulum"), [2.0, 1.5], [0.0, 0.0]
    found = opened(browser, folder, kg.web(system, x, step=0.01, method=method))
    ask(found, "page.advance(20);")
    library = load(kg.generate(system, (f"rollout_{method}",)), on_status="ignore")
    expected = library.rollout(x, y, steps=20, step=0.01)
    assert ask(found, "return [...page.competitors[0].runner.x];") == expected.x[-1].tolist()
    assert ask(found, "return [...page.competitors[0].runner.y];") == expected.y[-1].tolist()
    if method == "implicit_midpoint":
        reason = ask(found, "page.length = 3; page.advance(1); page.show(); return page.rows[0].error.title;")
        assert reason == "the step is too long, its iteration does not converge"
    assert found.messages == []
    found.close()


@pytest.mark.parametrize(("place", "name"), list(enumerate(VARIANTS)))
def test_chromium_computes_the_bits_of_native_code(pendulum, place, name):
    require_bits_of_native_code(pendulum, model("double_pendulum"), place, name)
    ask(pendulum, "page.reset()")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["satellite", "eight_body", "panda_arm"])
def test_pages_of_larger_models_are_small_and_have_the_bits_of_native_code(browser, folder, name):
    system = model(name)
    page = kg.web(system)
    assert len(page.html().encode()) < LARGEST
    found = opened(browser, folder, page)
    for place, competitor in enumerate(page.competitors):
        require_bits_of_native_code(found, system, place, competitor.name)
    assert found.messages == [] == found.requests
    found.close()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*this is not read:kanegen.errors.KanegenWarning")
@pytest.mark.parametrize("robot", ["panda", "go2"])
def test_pages_of_robots_are_small_and_show_a_picture(browser, folder, robot):
    page = kg.web(kg.load(robot_file(robot), floating_base=robot == "go2"))
    meshes = sum(len(one.vertices) + len(one.faces) for one in page.formulations[0].scene.meshes)
    assert len(page.html().encode()) - meshes < LARGEST
    found = opened(browser, folder, page)
    assert found.picture().std() > 0.01
    assert found.messages == [] == found.requests
    found.close()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_pages_of_random_trees_agree_with_the_reference(browser, folder, seed):
    """With force elements, parameters, couplings, all kinds of joints, and forces that depend on the time."""
    system = everything(seed, bodies=3).with_contacts([])
    found = opened(browser, folder, kg.web(system, step=1e-4))
    found.page.evaluate("kanegenWeb.shown.advance(10); kanegenWeb.shown.show()")
    errors = found.page.evaluate("kanegenWeb.shown.competitors.map((one) => [one.name, one.error])")
    double, single = dict(errors)["double"], dict(errors)["float"]
    assert double < 1e-10
    assert double < single
    assert found.messages == [] == found.requests
    found.close()


def test_the_reference_sums_pairs_of_doubles_exactly_enough(pendulum):
    rng = np.random.default_rng(0)
    high, factors = rng.standard_normal((2, 40)), rng.standard_normal(40)
    pairs = np.stack([high, high * rng.uniform(-1, 1, high.shape) * 2.0**-54], axis=-1)
    script = """return argument[2].map((factor, i) => {
        const into = new Float64Array(2);
        kanegenWeb.addScaled(into, argument[0][i], factor, argument[1][i]);
        return [...into, ...kanegenWeb.sixth(into)];
    })"""
    found = ask(pendulum, script, [pairs[0].tolist(), pairs[1].tolist(), factors.tolist()])
    for base, other, factor, (a, b, c, d) in zip(pairs[0], pairs[1], factors, found, strict=True):
        product = Fraction(factor) * sum(map(Fraction, other))
        exact = sum(map(Fraction, base)) + product
        size = max(abs(product), abs(sum(map(Fraction, base))))
        assert abs(Fraction(a) + Fraction(b) - exact) < size * Fraction(1, 2**100)
        sum_ = Fraction(a) + Fraction(b)
        assert abs(Fraction(c) + Fraction(d) - sum_ / 6) <= abs(sum_) * Fraction(1, 2**100)


def test_the_reference_is_the_method_of_runge_and_kutta_in_many_digits(browser, folder):
    """Steps of a pendulum, of which the textbook says the rates, by mpmath with 40 digits."""
    found = opened(browser, folder, kg.web(simple_pendulum(), [1.0], [0.5], step=0.0078125))
    script = "page.advance(20); return page.reference.runner.state.flatMap((one) => [...one])"
    pairs = ask(found, script)
    with mpmath.workdps(40):
        state, h = mpmath.matrix([1, 0.5]), mpmath.mpf(0.0078125)
        for _ in range(20):
            k1 = rates_of_a_pendulum(state)
            k2 = rates_of_a_pendulum(state + h / 2 * k1)
            k3 = rates_of_a_pendulum(state + h / 2 * k2)
            k4 = rates_of_a_pendulum(state + h * k3)
            state += h / 6 * (k1 + 2 * (k2 + k3) + k4)
        for high, low, exact in zip(pairs[::2], pairs[1::2], state, strict=True):
            assert abs(mpmath.mpf(high) + mpmath.mpf(low) - exact) < 1e-29
    found.close()


def test_errors_are_those_of_the_precisions(pendulum):
    ask(pendulum, "page.reset(); page.advance(400)")
    pendulum.page.keyboard.press("ArrowRight")
    double, single, coarse = ask(pendulum, "return page.competitors.map((one) => one.error)")
    assert 0 < double < 1e-13
    assert 1e-8 < single < 1e-3
    assert 1e-9 < coarse < 1e-2


def test_space_plays_and_the_mechanism_moves(pendulum):
    pendulum.page.keyboard.press("r")
    before = pendulum.picture()
    pendulum.page.keyboard.press(" ")
    wait(pendulum, "page.time > 0.2")
    pendulum.page.keyboard.press(" ")
    time = ask(pendulum, "return page.time")
    assert np.abs(pendulum.picture() - before).max() > 0.1
    assert ask(pendulum, "return page.time") == time
    pendulum.page.keyboard.press("r")
    assert ask(pendulum, "return page.time") == 0
    assert np.array_equal(pendulum.picture(), before)


def test_a_slider_of_a_length_moves_joints_links_and_masses(pendulum):
    slider = pendulum.page.get_by_role("slider", name="l1")
    slider.fill("1.8")
    script = """const { bodies } = page.mechanisms[0].scene;
        return { joint: bodies[2].joint.position, pose: [...page.competitors[0].poses],
            rod: bodies[1].shapes.find((shape) => shape.kind === "rod").size[1] }"""
    found = ask(pendulum, script)
    assert found["joint"] == pytest.approx([1.8, 0, 0], abs=1e-15)
    assert found["rod"] == pytest.approx(1.8, abs=1e-15)
    arm = np.array(found["pose"]).reshape(3, 12)[2, 9:]
    assert np.linalg.norm(arm) == pytest.approx(1.8, abs=1e-14)
    slider.fill("1")


def test_parameters_of_no_model_are_named(pendulum):
    ask(pendulum, "page.parameters[4] = 0; page.reset(); page.advance(1)")
    pendulum.page.keyboard.press("ArrowRight")
    assert "no such model" in pendulum.page.locator(".kw-table").inner_text()
    ask(pendulum, "page.parameters[4] = 0.7; page.reset()")
    assert "no such model" not in pendulum.page.locator(".kw-table").inner_text()


def test_the_row_of_a_motion_chooses_the_picture(pendulum):
    pendulum.page.get_by_role("button", name="float").click()
    assert ask(pendulum, "return page.shown") == 1
    pendulum.page.get_by_role("button", name="double", exact=True).click()
    assert ask(pendulum, "return page.shown") == 0


def test_settings_change_steps_and_the_reference(pendulum):
    pendulum.page.get_by_label("Runge-Kutta step").select_option("0.01")
    pendulum.page.get_by_label("Reference in").select_option("4")
    ask(pendulum, "page.advance(100)")
    pendulum.page.get_by_role("button", name="one step").click()
    (double, *_) = ask(pendulum, "return page.competitors.map((one) => one.error)")
    assert 1e-10 < double < 1e-3  # the error of the method, which equal steps do not show
    pendulum.page.get_by_label("Runge-Kutta step").select_option("0.001")
    pendulum.page.get_by_label("Reference in").select_option("1")


def test_evaluations_are_counted(pendulum):
    wait(pendulum, "[...page.rows, page.referenceRow].every((row) => row.rate.textContent !== '')")


def test_a_narrow_window_shows_the_picture_and_names_in_any_script(browser, folder):
    name = "</script><img src=x onerror=alert(1)> 摆锤"
    found = opened(browser, folder, kg.web(simple_pendulum(name)), NARROW)
    assert found.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert found.page.locator(".kg-stage canvas").bounding_box()["height"] > 250
    assert found.page.locator("h1").inner_text() == name
    assert found.page.title() == name
    assert found.messages == [] == found.requests
    found.close()


def test_a_motion_that_ends_says_when_and_why_it_was_lost(pendulum):
    ask(pendulum, "page.states[0].y[0] = 1e200; page.reset()")
    pendulum.page.get_by_role("button", name="one step").click()
    row = pendulum.page.locator(".kw-table tbody tr").first
    assert "lost at 0.00 s" in row.inner_text()
    assert row.locator(".kw-stopped").get_attribute("title") == "the result is not finite"
    ask(pendulum, "page.states[0].y[0] = 0; page.reset()")
    assert "lost" not in row.inner_text()


def test_what_has_no_motion_of_its_own_is_refused():
    system = simple_pendulum()
    with pytest.raises(OptionError, match=r"prescribed freedoms, such as .*Lock them"):
        kg.web(tree(KINDS[0], 0))
    with pytest.raises(OptionError, match=r"has contacts, .*with_contacts"):
        kg.web(everything(0).with_contacts([everything(0).bodies[-1].name]))
    with pytest.raises(OptionError, match=r"x: there is no 'q9'"):
        kg.web(model("double_pendulum"), {"q9": 1.0})
    with pytest.raises(OptionError, match="no finite number"):
        kg.web(system, [float("nan")])
    with pytest.raises(ArrayError, match="y: expected 1 values"):
        kg.web(system, None, [1.0, 2.0])
    for step in (0, -1.0, float("inf"), "1e-3", True):
        with pytest.raises(OptionError, match=r"step: .* is no positive number of seconds"):
            kg.web(system, step=step)
    with pytest.raises(OptionError, match="no System"):
        kg.web("arm.urdf")


def test_a_file_that_cannot_be_written_leaves_the_old_one(tmp_path, monkeypatch):
    page = kg.web(simple_pendulum())
    with pytest.raises(WriteError, match=r"ends in \.html"):
        page.save(tmp_path / "page.txt")
    (tmp_path / "page.html").write_text("old")

    def full(self, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.Path, "write_bytes", full)
    with pytest.raises(WriteError, match="No space left on device"):
        page.save(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]


def test_the_command_writes_a_page(tmp_path):
    file = ROOT / "models" / "double_pendulum.toml"
    command = [sys.executable, "-m", "kanegen", "web", str(file), "-o", "page.html", "--step", "0.002"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr, done.stdout.strip()) == (0, "", "wrote page.html")
    assert "kanegenWeb" in (tmp_path / "page.html").read_text()
