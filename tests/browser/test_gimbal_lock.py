"""The demonstration of gimbal lock: only the quaternion passes it without loss."""

import pytest

from benchmarks.gimbal_lock.page import QUARTER_TURN, STEP, gimbal_lock
from tests.support.browser import OpenPage


@pytest.mark.slow
def test_only_the_quaternion_passes_gimbal_lock_without_loss(browser, tmp_path):
    page = gimbal_lock()
    page.save(tmp_path / "page.html", play=False)
    found = OpenPage(browser).open(tmp_path / "page.html")
    found.page.evaluate(f"kanegenWeb.shown.advance({round(QUARTER_TURN / STEP)}); kanegenWeb.shown.show()")
    rates, velocity, quaternion = found.page.evaluate("kanegenWeb.shown.competitors.map((one) => one.error)")
    assert rates is None or not rates < 0.1  # NaN where the motion is lost
    assert velocity > 1e-5
    assert quaternion < 1e-11
    distances = [float(start.name.split("°")[0]) for start in page.starts]
    assert distances == sorted(distances)
    assert found.messages == [] == found.requests
    found.close()
