"""A learned policy in the cockpit, in a real browser."""

import pytest

from tests.policy_networks import ARM, METADATA, save

from .conftest import CockpitPage, Run, wait_for

# What a box shows from a click on, as each of 30 pictures is drawn, over a slow line.
TICKED = """async (box) => {
  const { send } = WebSocket.prototype;
  WebSocket.prototype.send = function (text) {
    setTimeout(() => send.call(this, text), 200);
  };
  const shown = [];
  box.click();
  while (shown.push(box.checked) < 30) await new Promise(requestAnimationFrame);
  WebSocket.prototype.send = send;
  return shown;
}"""

pytestmark = [pytest.mark.slow, pytest.mark.browser]


@pytest.fixture
def page(tmp_path, browser):
    """The page of a run in which a policy has an arm."""
    pytest.importorskip("aiohttp", reason="the cockpit is not installed")
    file = save(tmp_path / "arm.onnx", [0.0, 0.0], metadata=METADATA)
    run = Run(tmp_path, "teleop", "--port", "8380", "--policy", str(file))
    page = CockpitPage(browser, run.url)
    yield page
    assert not page.errors
    page.page.close()
    run.end()


def test_a_policy_shows_is_steered_by_keys_watched_and_taken_back(page):
    wait_for(lambda: page.frame(".policy.runs"), "the policy")
    whose = page.page.get_by_label(f"{ARM[0]}: the policy's")
    whose.wait_for()
    page.key("i")
    wait_for(lambda: page.frame(".policy.velocity")[0] == 0.8, "the velocity")
    page.key("k")
    wait_for(lambda: page.frame(".policy.velocity")[0] == 0.0, "rest")
    assert page.mode == "STAND"
    watchdog = page.page.get_by_label("Watchdog over the policy")
    assert all(watchdog.evaluate(TICKED))
    wait_for(lambda: page.frame(".policy.watched"), "the watchdog")
    page.press("None mine")
    wait_for(lambda: not page.frame(".policy.runs"), "its end")
    assert "gives its joints up" in page.events()
    page.press("POLICY")
    wait_for(lambda: page.frame(".policy.runs"), "the policy")
