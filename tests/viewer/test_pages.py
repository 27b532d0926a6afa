"""Pages in a headless browser: what they show, how they move, and that they ask nothing of a network."""

from __future__ import annotations

from hashlib import sha256
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.c.templates import raw
from tests.support.browser import NARROW, WIDE, OpenPage
from tests.support.paths import MODELS, ROOT
from tests.support.robots import robot_file

LARGEST = 3_000_000
"""Bytes of a page."""

BACKGROUND = {"light": (238, 241, 245), "dark": (20, 24, 31)}
"""Colours behind a picture."""


def robot(name: str, floating_base: bool = False) -> kg.System:
    return kg.load(robot_file(name), floating_base=floating_base)


def share_of_foreground(picture: np.ndarray, theme: str = "light") -> float:
    """The share of pixels that are far from the background and from the grid on it."""
    distance = np.abs(picture - np.array(BACKGROUND[theme]) / 255).max(axis=-1)
    return float((distance > 0.25).mean())


def is_moving(page: OpenPage) -> bool:
    """Whether two pictures, some time apart, differ."""
    before = page.picture()
    page.page.wait_for_timeout(300)
    return bool(np.abs(page.picture() - before).max() > 0.1)


@pytest.mark.parametrize(
    ("system", "size"),
    [
        pytest.param(lambda: robot("panda"), NARROW, id="panda", marks=pytest.mark.slow),
        pytest.param(lambda: robot("go2", floating_base=True), WIDE, id="go2", marks=pytest.mark.slow),
        pytest.param(lambda: kg.load(MODELS / "eight_body.toml"), WIDE, id="eight_body"),
    ],
)
@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
def test_a_page_shows_a_mechanism_and_moves_it(
    browser: Any, tmp_path: Path, system: Any, size: tuple[int, int]
) -> None:
    file = tmp_path / "page.html"
    kg.view(system()).save(file, play=False)
    assert file.stat().st_size < LARGEST
    page = OpenPage(browser, size).open(file)
    assert share_of_foreground(page.picture()) > 0.01
    assert not is_moving(page)
    page.page.get_by_role("button", name="Play").click()
    assert is_moving(page)
    page.page.get_by_role("button", name="Pause").click()
    assert not is_moving(page)
    assert not page.messages
    assert not page.requests
    page.close()


@pytest.fixture(scope="module")
def pendulum() -> kg.System:
    return kg.load(MODELS / "double_pendulum.toml").with_points({"tip": ("lower", (0, 0, -0.5))})


@pytest.fixture(scope="module")
def turning(browser: Any, pendulum: kg.System, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A page with a motion of ten seconds in which q1 is the time, in rad."""
    times = np.linspace(0.0, 10.0, 101)
    x = np.stack([times, 0 * times], axis=1)
    view = kg.view(
        pendulum, (times, x), paths=["tip"], forces={"tip": (0, 0, 3.0)}, plots={"cosine": np.cos(times)}
    )
    file = tmp_path_factory.mktemp("turning") / "turning.html"
    view.save(file, play=False)
    page = OpenPage(browser).open(file)
    yield page
    page.close()


def test_the_plot_follows_the_time_of_the_picture(turning: OpenPage) -> None:
    scrub = turning.page.get_by_role("slider", name="Time, s")
    scrub.fill("4")
    legend = turning.page.locator(".u-legend")
    assert "4.000 rad" in legend.inner_text()
    scrub.fill("7")
    assert "7.000 rad" in legend.inner_text()
    turning.page.get_by_label("Quantities in the plot").select_option("Further quantities")
    assert f"{np.cos(7.0):.4f}" in legend.inner_text()
    turning.page.get_by_label("Quantities in the plot").select_option("Coordinates, rad")


def test_a_click_into_the_plot_sets_the_time_of_the_picture(turning: OpenPage) -> None:
    turning.page.get_by_role("slider", name="Time, s").fill("0")
    before = turning.picture()
    box = turning.page.locator(".u-over").bounding_box()
    turning.page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    assert float(turning.page.get_by_role("slider", name="Time, s").input_value()) == pytest.approx(
        5, abs=0.1
    )
    assert np.abs(turning.picture() - before).max() > 0.1


def test_keys_play_step_and_look(turning: OpenPage) -> None:
    page = turning.page
    page.locator(".kg-stage").focus()
    page.keyboard.press("Home")
    start = turning.picture()
    page.keyboard.press("ArrowRight")
    assert page.locator(".kg-time").inner_text() == "0.05 s"
    page.keyboard.press("Home")
    page.keyboard.press("4")
    assert np.abs(turning.picture() - start).max() > 0.1
    page.keyboard.press("1")
    assert np.abs(turning.picture() - start).mean() < 0.002
    page.keyboard.press("n")
    page.locator(".kg-label:visible").first.wait_for()  # names are placed with the next picture
    assert page.locator(".kg-label:visible").all_inner_texts() == ["upper", "lower", "tip"]
    boxes = [name.bounding_box() for name in page.locator(".kg-label:visible").all()]
    for one, other in combinations(boxes, 2):
        sides = [
            abs(one[k] - other[k]) >= min(one[n], other[n]) for k, n in (("x", "width"), ("y", "height"))
        ]
        assert any(sides)
    page.keyboard.press("n")
    page.keyboard.press("t")
    theme = page.locator(".kg").get_attribute("data-theme")
    assert share_of_foreground(turning.picture(), theme) < 0.3
    page.keyboard.press("t")
    page.keyboard.press("Space")
    assert is_moving(turning)
    page.keyboard.press("Space")
    assert not turning.messages


def test_paths_and_forces_can_be_hidden(turning: OpenPage) -> None:
    turning.page.get_by_role("slider", name="Time, s").fill("3")
    for name in ("tip", "Forces", "Ground"):
        before = turning.picture()
        chip = turning.page.get_by_role("button", name=name, exact=True)
        chip.click()
        assert chip.get_attribute("aria-pressed") == "false"
        assert np.abs(turning.picture() - before).max() > 0.1, name
        chip.click()


def test_sliders_move_the_picture_and_go_back(browser: Any, pendulum: kg.System, tmp_path: Path) -> None:
    kg.view(pendulum, x={"q1": 0.5}).save(tmp_path / "sliders.html", play=False)
    page = OpenPage(browser).open(tmp_path / "sliders.html")
    before = page.picture()
    slider = page.page.get_by_role("slider", name="q2, rad")
    slider.fill("1.5")
    page.page.get_by_role("slider", name="q1, rad").press("ArrowRight")
    assert np.abs(page.picture() - before).max() > 0.1
    page.page.get_by_role("button", name="Reset").click()
    assert np.abs(page.picture() - before).max() < 0.02
    assert page.page.get_by_role("slider", name="q1, rad").input_value() == "0.5"
    page.close()


def test_names_show_on_hover_and_are_text_never_markup(browser: Any, tmp_path: Path) -> None:
    """Names may hold anything, in any script; none of it becomes part of the page."""
    name = '</script><script>document.title="run"</script><img src=x onerror="document.title=1"> 腕 ذراع'
    body = kg.Body(name, 0, 1.0, (0.1 * np.eye(3)).tolist(), joint=kg.Joint(free=(True,) + (False,) * 5))
    system = kg.System(name, (body,)).with_points({name + " tip": (1, (0, 0, 0.1))})
    times = np.linspace(0, 1, 5)
    view = kg.view(system, (times, times[:, None]), paths=[name + " tip"])
    view.save(tmp_path / "names.html", play=False)
    page = OpenPage(browser).open(tmp_path / "names.html")
    assert page.page.title() == name
    assert page.page.locator("h1").inner_text() == name
    assert page.page.locator("img").count() == 0
    box = page.page.locator(".kg-stage").bounding_box()
    page.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    tip = page.page.locator(".kg-tip")
    assert tip.locator("b").inner_text() == name
    assert "1 kg" in tip.inner_text()
    assert not page.messages
    page.close()
    page = OpenPage(browser)
    page.page.set_content(view._repr_html_())
    frame = page.page.frame_locator("iframe")
    assert frame.locator("h1").inner_text() == name
    page.close()


def test_the_bundle_is_the_one_of_the_sources() -> None:
    """`make viewer` writes the digest of all that goes in; without it the page would not do what viewer/
    says."""
    folder = ROOT / "viewer"
    names = ["build.mjs", "package.json", "package-lock.json"]
    names += [f"src/{path.name}" for path in sorted((folder / "src").iterdir())]
    digest = sha256()
    for name in names:
        digest.update(f"{name}\n{(folder / name).read_text(encoding='utf-8')}\n".encode())
    assert raw("viewer/viewer.js").startswith(f"/* kanegen viewer {digest.hexdigest()}\n")
    assert "three 0." in raw("viewer/LICENSES.txt") and "uplot 1." in raw("viewer/LICENSES.txt")
