"""Steering in the cockpit, in a real browser, as people do it."""

import math
import re
import time

import pytest

from .conftest import PHONE, SCREEN, drag, wait_for
from .looks import ACKNOWLEDGED

pytestmark = [pytest.mark.slow, pytest.mark.browser]

SOON = 100.0
"""Longest time from a press of STOP until the page says so [ms of wall time]."""
TRIES = 3
"""How often that is measured at most."""
WIDE = 120
"""Least width of the slider of k_effort [pixel]."""


# ---- modes, keys, STOP -----------------------------------------------------------


def test_modes_are_asked_for_lit_and_refused_with_a_reason(page):
    page.press("MANIPULATE")
    page.becomes("MANIPULATE")
    assert lit(page) == ["MANIPULATE"]
    step = page.button("STEP")
    assert step.get_attribute("aria-disabled") == "true"
    step.click(force=True)
    page.tells("STEP may follow STAND, not MANIPULATE")
    assert page.mode == "MANIPULATE"
    page.press("STOP")
    page.becomes("STAND")
    assert lit(page) == ["STAND"]
    page.press("FREEZE")
    page.becomes("FREEZE")
    assert "STAND -> FREEZE" in page.events()
    page.labelled("Search events").fill("FREEZE")
    wait_for(lambda: "STAND -> MANIPULATE" not in page.events(), "the search")
    assert "STAND -> FREEZE" in page.events()
    page.labelled("Search events").fill("no such thing")
    wait_for(lambda: "nothing has this word" in page.events(), "the search")
    page.labelled("Search events").fill("")


def lit(page):
    return page.page.locator(".behavior.lit").evaluate_all(
        "all => all.map((one) => one.getAttribute('aria-label'))"
    )


def test_keys_walk_and_escape_stops_even_from_a_field_and_from_a_menu(page):
    search = page.labelled("Search events")
    search.focus()
    page.key("i")
    assert search.input_value() == "i"
    search.fill("")
    page.page.locator("#view canvas").focus()
    page.page.evaluate("document.activeElement.blur()")
    page.key("i")
    page.becomes("WALK")
    wait_for(lambda: "step 1 landed" in page.events(), "a step")
    search.focus()
    page.key("Escape")
    page.becomes("stopping …")
    page.becomes("STAND")
    page.key("l")
    page.becomes("WALK")
    page.press("Show")
    menu = page.page.get_by_role("dialog", name="Show")
    menu.wait_for()
    page.key("Escape")
    page.becomes("stopping …")
    menu.wait_for(state="hidden")
    page.becomes("STAND")


def test_keys_work_after_a_list_was_used(page):
    pace = page.labelled("Pace")
    pace.focus()
    page.key("ArrowUp")
    wait_for(lambda: page.frame(".pace") == 2, "the pace")
    page.key("4")
    page.becomes("MANIPULATE")
    page.key("?")
    page.page.get_by_role("dialog", name="Keys").get_by_text("single step").wait_for()
    page.key("?")
    page.page.get_by_role("dialog", name="Keys").wait_for(state="hidden")


def test_stop_is_acknowledged_at_once(page, watching):
    for how in ("paused", "watching"):
        # Another program on the computer may delay a browser, but hardly each time.
        delays = []
        while not delays or (min(delays) > SOON and len(delays) < TRIES):
            delays.append(delay_of_stop(page, watching, how))
        assert min(delays) < SOON, how


def delay_of_stop(page, watching, how):
    """Time from a press of STOP in a walk until every page says so [ms]."""
    page.key("i")
    page.becomes("WALK")
    watching.becomes("WALK")
    presses = watching if how == "watching" else page
    if how == "paused":
        page.key("Space")
        wait_for(lambda: page.paused, "the pause")
    else:
        page.ask("rate", rate=1)
    for one in (page, watching):
        one.see(ACKNOWLEDGED)
    presses.press("STOP")
    pressed = presses.see("window.pressed")
    said = [one.see("window.acknowledged") for one in (page, watching)]
    if how == "watching":
        page.tells("pressed STOP")
    page.ask("rate", rate=0)
    page.ask("pause", on=False)
    page.becomes("STAND")
    return max(said) - pressed


# ---- time ------------------------------------------------------------------------


def test_time_is_paused_stepped_paced_and_turned_back(page):
    wait_for(lambda: page.time > 3.0, "three seconds")
    page.key("Space")
    wait_for(lambda: page.paused, "the pause")
    before = page.frame(".time")
    for _ in range(5):
        page.press("Single step")
    wait_for(lambda: page.frame(".time") > before + 0.099, "five steps of 20 ms")
    assert page.frame(".time") < before + 0.101
    page.press("Back 10 s")
    wait_for(lambda: page.frame(".time") < before - 2.0, "the time before")
    page.labelled("Pace").select_option("0.25")
    page.press("Pause")
    wait_for(lambda: not page.paused, "the run")
    begin, since = page.frame(".time"), time.monotonic()
    time.sleep(0.8)
    passed = page.frame(".time") - begin
    assert 0.05 < passed < 0.25 * (time.monotonic() - since) + 0.1
    page.press("New run")
    page.page.get_by_role("dialog", name="New run").get_by_label("Seed").fill("3")
    page.press("Begin")
    wait_for(lambda: page.frame(".time") < 0.2, "another run")
    page.until("cockpit.page.settings.seed == 3")


# ---- joints ----------------------------------------------------------------------


@pytest.mark.parametrize("size", [PHONE, SCREEN])
def test_a_slider_gives_a_part_of_the_chosen_limb(page, size):
    page.page.set_viewport_size(size)
    page.button("l_arm").press("Enter")
    slider = page.page.get_by_role("slider", name="k_effort of l_arm")
    assert slider.bounding_box()["width"] >= WIDE
    slider.click()  # In the middle.
    half = page.page.get_by_role(
        "button", name=re.compile("^l_arm_wrx: k_effort 12[78]$")
    )
    half.wait_for()
    box = half.locator(".ring")
    red, green, blue = (
        int(box.get_attribute("fill")[i : i + 2], 16) for i in (1, 3, 5)
    )
    assert (red, green, blue) == pytest.approx((0xA8, 0x4D, 0xAD), abs=2)  # Violet.
    whole = page.button("r_arm_wrx: behavior").locator("path").get_attribute("d")
    assert half.locator("path").get_attribute("d") not in ("", whole)
    before = int(slider.input_value())
    slider.press("ArrowRight")
    page.button(f"l_arm_wrx: k_effort {before + 1}").wait_for()
    slider.press("End")
    page.button("l_arm_wrx: yours").wait_for()
    page.press("None mine")
    page.button("l_arm_wrx: behavior").wait_for()


def test_joints_change_hands_in_the_figure_and_move(page):
    right, left = (page.button(f"{side}_arm_ely: behavior") for side in "rl")
    assert right.bounding_box()["x"] < left.bounding_box()["x"]
    sides = page.page.locator(".figure text").all()
    assert [one.text_content() for one in sides] == ["R", "L"]
    assert sides[0].bounding_box()["x"] < sides[1].bounding_box()["x"]
    right.click()
    page.button("r_arm_ely: yours").wait_for()
    index = joint(page, "r_arm_ely")
    assert page.frame(".command.k_effort").count(255) == 1
    knob = page.page.get_by_role("slider", name="r_arm_ely [rad]")
    assert knob.is_enabled()
    assert page.page.get_by_role("slider", name="r_arm_elx [rad]").is_disabled()
    before = page.frame(f".record.joints.position[{index}]")
    box = knob.bounding_box()
    middle = box["y"] + 0.5 * box["height"]
    place = (box["x"] + before / math.pi * box["width"], middle)
    drag(page.page, place, (box["x"] + 0.4 * box["width"], middle))
    wait_for(
        lambda: page.frame(f".record.joints.position[{index}]") < before - 0.2,
        "the elbow, by mouse",
    )
    knob.press("End")
    wait_for(
        lambda: page.frame(f".record.joints.position[{index}]") > before + 0.2,
        "the elbow, by a key",
    )
    page.page.mouse.click(*page.page.evaluate(ON_BONE, "r_arm"))  # Again: all of it.
    page.button("r_arm_wrx: yours").wait_for()
    page.press("None mine")
    page.button("r_arm_ely: behavior").wait_for()


ON_BONE = """(limb) => {
  const bones = document.querySelectorAll(`.limb[aria-label=${limb}] line`);
  for (const bone of bones) {
    const { x, y, width, height } = bone.getBoundingClientRect();
    const at = [x + width / 2, y + height / 2];
    if (document.elementFromPoint(...at) === bone) return at;
  }
}"""
"""Where a limb can be clicked beside its joints [pixel]."""


def joint(page, name):
    """Index of a joint in the messages."""
    names = page.page.evaluate("cockpit.page.run.joints.map((one) => one.name)")
    return names.index(name)


def test_joints_are_held_and_limp_and_have_gains(page):
    page.press("Arms mine")
    page.button("l_arm_shx: yours").wait_for()
    page.button("r_arm_shx: yours").wait_for()
    index = joint(page, "r_arm_shy")
    gain = f".command.kp_position[{index}]"
    page.press("Go limp")
    wait_for(lambda: page.frame(gain) == 0, "no stiffness")
    page.press("Hold")
    wait_for(lambda: page.frame(gain) > 0, "stiffness")
    page.press("Gains of r_arm_shy")
    menu = page.page.get_by_role("dialog", name="Gains of r_arm_shy")
    before = page.frame(gain)
    menu.get_by_label("kp_position").fill("-1")
    page.press("Apply")
    assert menu.locator("input:invalid").count() == 1
    assert page.frame(gain) == before
    menu.get_by_label("kp_position").fill("321")
    page.press("Apply")
    wait_for(lambda: page.frame(gain) == 321, "the gain")


def test_poses_are_saved_and_gone_to(page):
    page.press("Arms mine")
    page.button("r_arm_elx: yours").wait_for()
    position = f".record.joints.position[{joint(page, 'r_arm_elx')}]"
    before = page.frame(position)
    page.press("Pose")
    page.labelled("Save as").fill("arms ahead")
    page.labelled("Save as").press("Enter")
    go = page.button("Go to arms ahead")
    go.wait_for()
    page.key("Escape")
    page.page.get_by_role("slider", name="r_arm_elx [rad]").press("Home")
    wait_for(lambda: page.frame(position) < before - 0.5, "another pose")
    page.press("Pose")
    go.click()
    wait_for(lambda: abs(page.frame(position) - before) < 0.05, "the pose")


# ---- pelvis and walking ----------------------------------------------------------


def test_the_pelvis_has_numbers_and_says_what_is_clamped(page):
    page.tab("Pelvis")
    panel = page.page.get_by_role("tabpanel", name="Pelvis")
    shown = panel.locator(".numbers .number").all_inner_texts()
    assert re.fullmatch(r"0\.[89]\d+ m", shown[0])
    assert all(re.fullmatch(r"-?\d\.\d+ (m|rad)", one) for one in shown)
    slider = page.page.get_by_role("slider", name="pelvis height")
    assert slider.is_disabled()
    panel.get_by_role("button", name="MANIPULATE").click()
    page.becomes("MANIPULATE")
    wait_for(slider.is_enabled, "the slider")
    slider.press("ArrowDown")
    panel.get_by_text("as asked for").wait_for()
    slider.press("End")
    clamped = re.compile(r"clamped: pelvis height \d\.\d\d → \d\.\d\d m")
    panel.get_by_text(clamped).wait_for()


def test_the_gait_is_set_and_the_pad_walks(page):
    page.tab("Walk")
    panel = page.page.get_by_role("tabpanel", name="Walk")
    stride = page.page.get_by_role("slider", name="stride")
    before = float(stride.input_value())
    stride.press("ArrowRight")
    panel.get_by_text(f"{before + 0.01:.2f} m").wait_for()
    assert page.page.evaluate("cockpit.page.walking.gait.stride") == pytest.approx(
        before + 0.01
    )
    stride.press("ArrowLeft")
    page.press("turn left")
    page.becomes("WALK")
    turn = page.button("turn left")
    wait_for(lambda: "lit" in turn.get_attribute("class"), "the light")
    page.press("stop walking")
    page.becomes("STAND")


def test_a_place_is_planned_by_numbers_with_a_heading_in_degrees(page):
    page.tab("Walk")
    for name, value in (("x [m]", 3), ("y [m]", 0.2), ("heading [°]", 90)):
        page.labelled(name).fill(str(value))
    page.press("Plan")
    page.page.get_by_text(re.compile(r"Planned: \d+ steps")).wait_for()
    wait_for(lambda: plan(page), "the plan")
    assert sum(step[3] for step in plan(page)[-2:]) / 2 == pytest.approx(
        math.pi / 2, abs=0.05
    )
    # The plan is seen as a whole from above.
    picture = page.page.locator(".from-above svg").bounding_box()
    steps = page.page.locator(".from-above .step")
    wait_for(lambda: steps.count() == len(plan(page)), "the steps from above")
    for step in steps.all():
        box = step.bounding_box()
        assert box["x"] >= picture["x"]
        assert box["x"] + box["width"] <= picture["x"] + picture["width"]
    page.press("Drop plan")
    wait_for(lambda: not plan(page), "no plan")
    assert page.mode == "STAND"


def plan(page):
    """Footsteps of the plan that is not sent yet, as foot, x, y, yaw."""
    return page.page.evaluate("cockpit.page.walking.plan")


def test_a_click_on_the_ground_plans_and_a_second_one_walks(page):
    page.press("Above")
    hint = page.page.locator("#hint")
    place = page.at_W(0.5, 0.05, 0)
    page.page.mouse.click(*place)
    wait_for(lambda: "Click again" in hint.inner_text(), "the hint")
    page.key("Escape")
    wait_for(lambda: hint.inner_text() == "" and not plan(page), "no plan")
    # With a heading; then a footstep is dragged.
    page.key("g")
    away = page.at_W(0.5, 0.55, 0)
    drag(page.page, place, (place[0], 0.5 * (place[1] + away[1])), away)
    ahead = pytest.approx(math.pi / 2, abs=0.1)
    wait_for(lambda: plan(page) and plan(page)[-1][3] == ahead, "the heading")
    wait_for(lambda: "Click again" in hint.inner_text(), "the hint")
    page.key("Escape")
    wait_for(lambda: not plan(page), "no plan")
    page.page.mouse.click(*place)
    wait_for(lambda: "Click again" in hint.inner_text() and plan(page), "the hint")
    x, y = plan(page)[-1][1:3]
    end = page.at_W(x + 0.06, y + 0.06, 0)
    moved = pytest.approx([x + 0.06, y + 0.06], abs=0.02)
    assert not [step for step in plan(page) if step[1:3] == moved]
    drag(page.page, page.at_W(x, y, 0), (end[0] + 15, end[1] + 15), end)
    wait_for(
        lambda: [step for step in plan(page) if step[1:3] == moved], "the footstep"
    )
    page.page.mouse.click(*page.at_W(0.4, 0.6, 0))
    page.becomes("WALK")
    page.becomes("STAND")
    assert page.frame(".robot")[:2] == pytest.approx([0.5, 0.05], abs=0.1)
    prints = (
        "Object.values(cockpit.find('/atlas_drake/shapes/footsteps').children)"
        ".filter((one) => one.object.visible).length"
    )
    assert page.page.evaluate(prints)
    page.press("Reset")
    wait_for(lambda: not page.page.evaluate(prints), "the end of the footprints")


GOAL = """(() => {
  viewer.scene.updateMatrixWorld(true);
  cockpit.steps.forEach((step) => step());
  return cockpit.page.view.hand.goal().toArray();
})()"""
"""Where the goal of a hand is in W, as the next picture shows it."""


def test_a_hand_is_dragged_previewed_and_goes_where_it_is_told(page):
    hint = page.page.locator("#hint")
    page.until("cockpit.isComplete()")
    page.press("Front")
    page.press("Move hand")
    wait_for(lambda: "Drag an arrow" in hint.inner_text(), "the goal")
    x, y, z = page.page.evaluate(GOAL)
    drag(
        page.page,
        page.at_W(x, y, z + 0.2),
        page.at_W(x, y, z + 0.3),
        page.at_W(x, y, z + 0.4),
    )
    wait_for(lambda: "Click the ball" in hint.inner_text(), "the ghost")
    there = page.page.evaluate(GOAL)
    assert there == pytest.approx([x, y, z + 0.2], abs=0.02)
    assert not any(page.frame(".command.k_effort"))
    page.page.mouse.click(*page.at_W(*there))
    page.tells("r_hand gets there")
    wait_for(lambda: 255 in page.frame(".command.k_effort"), "the arm")
    page.goes_on()
    page.goes_on()
    page.goes_on()
    assert page.page.evaluate(GOAL) == pytest.approx(there, abs=0.01)
    page.key("Escape")
    wait_for(lambda: hint.inner_text() == "", "no goal")


# ---- the view --------------------------------------------------------------------


def test_the_camera_stays_above_the_ground_and_comes_back(page):
    page.press("Follow")
    follows = camera(page)
    page.press("Free")
    page.at_W(0, 0, 0)  # Turns the camera, which has not drawn.
    box = page.page.locator("#view").bounding_box()
    x, top = box["x"] + 20, box["y"] + 60
    bottom = box["y"] + box["height"] - 20
    # Around the robot, away from it, and sideways.
    drag(page.page, (x, bottom), (x, 0.5 * (top + bottom)), (x, top))
    assert camera(page)[1] == pytest.approx(0.05, abs=0.01)
    page.page.mouse.wheel(0, 2000)
    assert camera(page)[1] == pytest.approx(0.05, abs=0.01)
    page.page.keyboard.down("Shift")
    drag(page.page, (x, top), (x, 0.5 * (top + bottom)), (x, top))
    for _ in range(3):
        drag(page.page, (x, top), (x, bottom), (x, top + 5))
    page.page.keyboard.up("Shift")
    assert camera(page)[1] >= 0.04
    assert camera(page) != pytest.approx(follows, abs=0.5)
    page.key("c")
    assert camera(page) == pytest.approx(follows, abs=0.05)
    assert page.button("Follow").get_attribute("aria-pressed") == "true"


def camera(page):
    """Place of the camera two frames later, its height in the middle [m]."""
    return page.page.evaluate(
        "new Promise(done => requestAnimationFrame(() => requestAnimationFrame("
        "() => done(viewer.camera.position.toArray()))))"
    )


def test_a_link_says_whose_it_is_and_is_pushed_by_the_mouse(page):
    page.until("cockpit.isComplete()")
    page.press("Front")
    card = page.page.locator(".link")

    def asks():
        # The view of a busy computer shows the robot late, and the ground in its place.
        page.key("Escape")
        page.page.mouse.click(*page.at_W(*chest_W(page)))
        return card.is_visible()

    wait_for(asks, "the card of the link")
    card.get_by_text("the behavior has it").wait_for()
    owned = card.locator("b").inner_text().split(": ")[1]
    page.press("Take it")
    page.button(f"{owned}: yours").wait_for()
    page.button(f"{owned}: yours").click()  # The card follows.
    card.get_by_text("the behavior has it").wait_for()
    page.button(f"{owned}: behavior").click()
    card.get_by_text("you have it").wait_for()
    page.press("Give it back")
    page.button(f"{owned}: behavior").wait_for()
    page.press("Close")
    card.wait_for(state="hidden")
    chest = page.at_W(*chest_W(page))
    drag(page.page, chest, (chest[0] + 20, chest[1]), (chest[0] + 40, chest[1]))
    page.tells(re.compile(r"Pushed utorso: 0\.\d\d m/s"))
    wait_for(lambda: "push" in page.events().lower(), "the push")


def chest_W(page):
    x, y, z, _ = page.frame(".robot")
    return x + 0.1, y, z + 0.45


def test_overlays_are_switched(page):
    page.press("Show")
    switch = page.page.get_by_role("switch", name="forces")
    assert not switch.is_checked()
    for now in (True, False):
        switch.click()
        wait_for(lambda: ("forces" in page.frame(".overlays")) == now, "the overlay")  # noqa: B023
        assert switch.is_checked() == now


def test_a_fall_says_what_failed_first_and_a_reset_stands_up_again(page):
    page.press("Push")
    page.labelled("Impulse [N·s]").fill("400")
    page.press("Push now")
    page.becomes("FALLEN")
    fall = page.page.get_by_role("alert").filter(has_text="Fell at")
    fall.get_by_text(
        re.compile(r"Fell at \d+\.\d s\. First: .+ at \d+\.\d s")
    ).wait_for()
    page.key("Escape")  # Closes the menu.
    page.button("MANIPULATE").click(force=True)
    page.tells("The robot has fallen: reset it")
    page.press("Reset (r)")
    page.becomes("STAND")
    fall.wait_for(state="hidden")
    page.goes_on()
    assert page.mode == "STAND"


def test_without_a_graphics_card_pictures_are_coarse_and_few(page):
    page.draw(True)
    wait_for(lambda: page.page.evaluate("cockpit.slow"), "a picture")
    ratio = "viewer.renderer.getPixelRatio()"
    wait_for(lambda: page.page.evaluate(ratio) == 0.5, "a coarse picture")
    drawn = page.page.evaluate(DRAWN_MEANWHILE)
    page.draw(False)
    assert drawn["pictures"] >= 1
    assert drawn["share"] < 0.75


DRAWN_MEANWHILE = """new Promise((done) => {
  const begin = performance.now();
  let pictures = 0, before = null, drawing = 0, last = null;
  const look = (now) => {
    if (before !== null && cockpit.drawing) drawing += now - before;
    if (cockpit.drawing && cockpit.drawing !== last) pictures += 1;
    last = cockpit.drawing;
    before = now;
    if (now - begin < 2000) requestAnimationFrame(look);
    else done({ pictures, share: drawing / (now - begin) });
  };
  requestAnimationFrame(look);
})"""
"""Counts pictures of two seconds, and the share of the time that they take."""
