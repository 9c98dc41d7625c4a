"""The demonstration in the cockpit, in a real browser."""

import pytest

from atlas_drake.clients.cli.exit_status import INTERRUPTED
from atlas_drake.simulation.tutorial import STEPS

from .conftest import CockpitPage, Run, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.browser]


@pytest.fixture
def page(tmp_path, browser):
    pytest.importorskip("aiohttp", reason="the cockpit is not installed")
    run = Run(tmp_path, "demo", "--cockpit", "--port", "8380")
    page = CockpitPage(browser, run.url)
    yield page
    assert not page.errors
    page.page.close()
    run.end(INTERRUPTED)


def test_the_demo_shows_its_steps_until_somebody_takes_over(page):
    steps = page.page.get_by_role("list", name="Steps of the tutorial")
    titles = steps.locator("li b").all_inner_texts()
    assert titles == [step.title for step in STEPS]
    assert all(steps.locator("li p").all_inner_texts())
    pace = page.labelled("Pace")
    pace.select_option("0")
    lit = steps.locator("li[aria-current] b")
    wait_for(lambda: page.time > STEPS[1].begin + 0.5, "the second step")
    # What comes now has to be done before the third step, by a busy machine too.
    pace.select_option("0.1")
    assert lit.all_inner_texts() == [STEPS[1].title]
    assert steps.locator("li.done b").all_inner_texts() == [STEPS[0].title]
    page.becomes("STAND")
    page.press("Take over")
    steps.wait_for(state="hidden")
    page.steering_says("You steer")
    assert page.time < STEPS[2].begin
    pace.select_option("0")
    wait_for(lambda: page.time > STEPS[3].begin + 0.5, "the time of the walk")
    assert page.mode == "STAND"
    assert not any(page.frame(".command.k_effort"))
    page.key("4")
    page.becomes("MANIPULATE")
