"""Laws of a walk, on the records of every tick."""

import itertools
import math

import numpy as np
import pytest

from atlas_drake import AtlasBehaviorStepData, AtlasSimInterfaceCommand
from atlas_drake.behaviors.balance import StanceConfig
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.messages import Quaternion, WalkStatus
from atlas_drake.messages.event import STEPS_LEFT
from atlas_drake.support_polygon import SupportPolygon
from atlas_drake.units import GRAVITY
from tests.play import SIDE, loads, play, stands

CONFIG = WalkConfig()
RULES, TIMING = CONFIG.rules, CONFIG.timing
DURATION = 0.63
LEFT, RIGHT = 0, 1
TOUCHDOWN = {"phase": "touchdown", "foot": "left", "count": 1, "duration": 0.05}
AHEAD, BACK, TO_LEFT, TO_RIGHT = 0.0, math.pi, 0.5 * math.pi, -0.5 * math.pi


def walk(*steps, first=1, demo=False):
    """A WALK message of steps, each an x or (x, yaw), the left foot first."""
    command = AtlasSimInterfaceCommand(behavior="WALK")
    command.walk_params.use_demo_walk = demo
    for place, step in enumerate(steps):
        x, yaw = step if isinstance(step, tuple) else (step, 0.0)
        index = first + place
        data = AtlasBehaviorStepData(index, (index - 1) % 2, duration=DURATION)
        data.swing_height = 0.1
        side = 0.12 * SIDE[data.foot_index]
        data.pose.position.x = x - side * math.sin(yaw)
        data.pose.position.y = side * math.cos(yaw)
        data.pose.orientation = Quaternion.from_wxyz(
            [math.cos(0.5 * yaw), 0.0, 0.0, math.sin(0.5 * yaw)]
        )
        command.walk_params.step_queue[place] = data
    return command


def pushed(speed, direction, robot, **scenario):
    """A walk of four steps, pushed as the left foot lands first."""
    push = {"impulse": speed * robot.mass, "direction": direction, **TOUCHDOWN}
    return play(walk(0.2, 0.4, 0.6, 0.6), pushes=[push], **scenario)


def index_of(record):
    return record.walk.current_step_index


def in_air(record):
    """True while the step that began last is still to land."""
    index = index_of(record)
    return index > 0 and record.walk.step_queue_saturated[0].step_index == index


def is_stepping(index):
    """Whether this step has its foot in the air."""
    return lambda record: in_air(record) and index_of(record) == index


def lift_offs(run):
    """The numbers of the records in which a foot lifts off."""
    flying = [in_air(record) for record in run.records]
    return [k for k in range(1, len(flying)) if flying[k] and not flying[k - 1]]


def dcm_error(record):
    return float(np.hypot(*(record.balance.dcm - record.balance.dcm_reference)))


@pytest.fixture(scope="module")
def plain():
    """A walk that turns, in which nothing happens."""
    return play(walk((0.15, 0.15), (0.3, 0.3), (0.3, 0.3)))


@pytest.fixture(scope="module")
def waiting(robot):
    """A walk in which a push back keeps the second foot on the ground."""
    return pushed(0.3, BACK, robot)


@pytest.fixture(scope="module")
def hurried(robot):
    """A walk in which a push to the right brings the second step forward."""
    return pushed(0.7, TO_RIGHT, robot)


@pytest.fixture(scope="module")
def again(robot):
    """A walk in which a push to the left has the left foot step twice."""
    return pushed(0.5, TO_LEFT, robot)


# ---- lift-off ----------------------------------------------------------------


@pytest.mark.slow
def test_a_foot_lifts_off_as_planned_when_the_dcm_is_near_its_plan(plain):
    for k in lift_offs(plain):
        assert dcm_error(plain.records[k - 1]) < RULES.dcm_ready
    landed = [event.time for event in plain.events("footstep")]
    begun = [plain.records[k].time for k in lift_offs(plain)]
    expected = [t + TIMING.transfer(DURATION) for t in landed[:-1]]
    np.testing.assert_allclose(begun[1:], expected, atol=0.03)


def rule(**values):
    """The controller with other rules of the walk."""
    return {"walk": {"rules": values}}


def delay(run):
    """The time between the planned and the actual second lift-off [s]."""
    landed = run.events("footstep")[0].time
    return run.records[lift_offs(run)[1]].time - landed - TIMING.transfer(DURATION)


@pytest.mark.slow
def test_a_foot_waits_for_the_dcm_but_not_longer_than_it_may(waiting, robot):
    assert delay(waiting) == pytest.approx(RULES.longest_wait, abs=0.03)
    assert not waiting.sim.has_fallen
    # The plan stands still meanwhile, and both feet may carry.
    planned = waiting.events("footstep")[0].time + TIMING.transfer(DURATION)
    held = [waiting.at(planned + wait).balance.dcm_reference for wait in (0.05, 0.2)]
    np.testing.assert_allclose(*held, atol=2e-3)


@pytest.mark.slow
def test_the_longest_wait_is_where_the_configuration_has_it(robot):
    short = pushed(0.3, BACK, robot, controller=rule(longest_wait=0.1))
    assert delay(short) == pytest.approx(0.1, abs=0.03)


@pytest.mark.slow
def test_a_foot_does_not_wait_with_a_straight_leg(waiting, robot):
    straight = rule(straight_flexion=3.0)
    assert delay(pushed(0.3, BACK, robot, controller=straight)) < 0.02


def has_lost_dcm(record):
    """Whether the DCM is farther outside the support than its plan, by a margin."""
    balance = record.balance
    support = SupportPolygon(balance.support)
    outside = support.distance_outside(balance.dcm)
    planned = support.distance_outside(balance.dcm_reference)
    return outside - max(planned, 0.0) > RULES.dcm_lost


@pytest.mark.slow
def test_a_lost_dcm_brings_lift_off_forward(hurried):
    assert delay(hurried) < -0.02
    assert not hurried.sim.has_fallen


def test_a_foot_lifts_off_as_soon_as_the_dcm_is_lost(hurried):
    lifted = lift_offs(hurried)[1]
    assert has_lost_dcm(hurried.records[lifted])
    assert not has_lost_dcm(hurried.records[lifted - 1])


@pytest.mark.slow
def test_a_foot_that_landed_steps_again_if_the_dcm_is_beyond_its_outer_side(again):
    (event,) = again.events("recovery")
    assert "(left)" in event.text
    feet = [step.data["foot"] for step in again.events("footstep")]
    assert feet == [LEFT, LEFT, RIGHT, LEFT, RIGHT]
    # The commanded steps go on after it.
    indices = [step.data["index"] for step in again.events("footstep")]
    assert indices == [1, 1, 2, 3, 4]
    assert not again.sim.has_fallen


def test_the_foot_that_lifts_off_next_is_unloaded_evenly(plain):
    weight = plain.sim.robot.mass * GRAVITY
    for begun in lift_offs(plain)[1:]:
        foot = plain.records[begun].walk.step_queue_saturated[0].foot_index
        last = TIMING.transfer(DURATION) * RULES.unload_share
        for record in plain.records[begun - 6 : begun]:
            left = plain.records[begun].time - record.time
            most = min(left / last, 1.0)
            assert loads(record)[foot] / weight < most + 0.1
        assert loads(plain.records[begun])[foot] / weight < 0.2


# ---- swing -------------------------------------------------------------------


def landing_places(run):
    """For each step: times, and landing places of its foot in the air, (k, 2)."""
    flying = [record for record in run.records if in_air(record)]
    for index, ticks in itertools.groupby(flying, index_of):
        ticks = list(ticks)
        steps = [record.walk.step_queue_saturated[0].pose.position for record in ticks]
        yield index, ticks, np.array([[step.x, step.y] for step in steps])


def test_no_step_moves_without_need(plain):
    for _, _, places in landing_places(plain):
        assert np.ptp(places, axis=0).max() < 0.01


def test_balance_moves_a_landing_place_but_not_at_the_end_of_the_swing(hurried):
    moved = []
    for _, ticks, places in landing_places(hurried):
        changes = np.abs(np.diff(places, axis=0)).max(axis=1)
        moved.append(changes.max())
        late = [r.walk.t_step_rem < RULES.frozen_end - 0.01 for r in ticks[1:]]
        assert not changes[late].any()
    assert max(moved) > 0.02


def test_a_foot_lands_when_it_is_loaded_and_not_before(plain, hurried):
    for run in (plain, hurried):
        weight = run.sim.robot.mass * GRAVITY
        for landing in run.events("footstep"):
            foot = landing.data["foot"]
            felt = loads(run.at(landing.time))[foot]
            assert felt > RULES.landing_force * weight
            before = [r for r in run.records if 0.02 < landing.time - r.time < 0.06]
            for record in before:
                assert loads(record)[foot] < RULES.landing_force * weight


@pytest.mark.slow
def test_a_stumble_is_no_touchdown():
    """A foot that meets a block early in its swing goes on."""
    block = {"size": [0.02, 0.3, 0.02], "position": [0.16, 0.12, 0.02]}
    run = play(walk(0.25, 0.25), terrain=[block])
    (first, *_) = run.events("footstep")
    weight = run.sim.robot.mass * GRAVITY
    flying = [r for r in run.records if in_air(r) and r.time < first.time - 0.2]
    assert first.data["index"] == 1
    assert max(loads(record)[LEFT] for record in flying) < 0.5 * weight


def test_the_foot_in_the_air_carries_nothing_and_the_other_one_everything(plain):
    weight = plain.sim.robot.mass * GRAVITY
    for _, ticks, _ in landing_places(plain):
        foot = ticks[0].walk.step_queue_saturated[0].foot_index
        middle = ticks[len(ticks) // 2]
        assert loads(middle)[foot] == 0.0
        assert loads(middle)[1 - foot] == pytest.approx(weight, rel=0.25)


# ---- the plan ----------------------------------------------------------------


@pytest.mark.slow
def test_the_paths_lead_from_the_present_to_the_step_and_to_rest():
    run = play(walk(0.2, 0.4, 0.4), seconds=1.0)
    run.until(is_stepping(1))
    run.advance(0.2)
    record, paths = run.sim.record, run.sim.output("planned_paths")
    step = record.walk.step_queue_saturated[0].pose.position
    np.testing.assert_allclose(paths.swing[-1][:2], [step.x, step.y], atol=2e-3)
    np.testing.assert_allclose(paths.dcm[0], record.balance.dcm_reference, atol=1e-9)
    np.testing.assert_allclose(paths.com[0], record.balance.com[:2], atol=1e-9)
    # ċ = ω(ξ - c) along the whole way.
    period = 0.04
    rate = np.diff(paths.com, axis=0) / period
    apart = paths.dcm - paths.com
    omega = record.balance.omega
    np.testing.assert_allclose(rate, omega * 0.5 * (apart[1:] + apart[:-1]), atol=6e-3)
    # It ends at rest, between the last two steps.
    run.until(stands)
    feet = np.array(
        [run.sim.record.feet.left_position, run.sim.record.feet.right_position]
    )
    for path in (paths.com, paths.dcm, paths.cop):
        np.testing.assert_allclose(path[-1], feet.mean(axis=0)[:2], atol=0.03)


def test_the_cop_of_single_support_is_planned_inside_the_stance_sole(plain):
    for _, ticks, _ in landing_places(plain):
        middle = ticks[len(ticks) // 2]
        foot = 1 - middle.walk.step_queue_saturated[0].foot_index
        feet = middle.feet
        sole = (feet.left_position, feet.right_position)[foot][:2]
        away = np.hypot(*(middle.balance.cop_reference - sole))
        assert away == pytest.approx(CONFIG.cop_inward, abs=0.003)


def test_the_trunk_turns_with_the_feet(plain):
    w, _, _, z = plain.sim.record.pelvis.orientation
    assert 2.0 * math.atan2(z, w) == pytest.approx(0.3, abs=0.03)


# ---- its end -----------------------------------------------------------------


def test_a_walk_is_over_when_the_robot_has_come_to_rest(plain):
    over = plain.records[-1]
    assert stands(over)
    assert np.abs(over.balance.com_velocity).max() < RULES.rest_speed
    last = plain.events("footstep")[-1].time
    assert over.time - last == pytest.approx(TIMING.settle + TIMING.rest, abs=0.05)
    (flags,) = {r.walk.status_flags for r in plain.records if last < r.time < over.time}
    why = WalkStatus.WARNING_INSUFFICIENT_STEP_DATA
    assert flags == WalkStatus.SUBSTATE_CATCHING | why


@pytest.mark.slow
def test_a_walk_without_steps_says_so():
    run = play(walk())
    (event,) = run.events(STEPS_LEFT)
    assert event.text.startswith("WALK ends without a step")


@pytest.mark.slow
@pytest.mark.parametrize("early", [0.45, 0.1], ids=["in a swing", "in a transfer"])
def test_a_request_to_stand_drops_the_steps_that_have_not_begun(early):
    run = play(walk(0.2, 0.4, 0.6, 0.6), seconds=1.0)
    run.until(is_stepping(2))
    if early < 0.2:
        run.until(lambda record: not in_air(record))
    run.ask("STAND")
    run.until(stands)
    # A foot in the air lands first; with both feet down the robot settles at once.
    assert [step.data["index"] for step in run.events("footstep")] == [1, 2]
    # Nothing is left out if the end was asked for.
    assert run.events(STEPS_LEFT) == []


@pytest.mark.slow
def test_steps_that_come_while_the_robot_settles_are_taken():
    run = play(walk(0.2, 0.2), seconds=1.0)
    run.until(lambda r: r.walk.status_flags & WalkStatus.SUBSTATE_CATCHING)
    run.sim.publish(walk(0.4, 0.4, first=3))
    run.advance(0.1)
    assert run.sim.record.walk.status_flags & WalkStatus.SUBSTATE_SWAYING
    run.until(stands)
    landings = [step.data for step in run.events("footstep")]
    assert [step["index"] for step in landings] == [1, 2, 3, 4]
    assert max(step["error_m"] for step in landings) < 0.01


@pytest.mark.slow
def test_a_step_that_comes_in_the_swing_of_the_last_one_gets_a_weight_shift():
    run = play(walk(0.2), seconds=0.9)
    run.until(is_stepping(1))
    run.sim.publish(walk(0.4, first=2))
    run.until(is_stepping(2))
    landed = run.events("footstep")[0].time
    assert run.sim.time - landed == pytest.approx(TIMING.first_shift, abs=0.05)


# ---- messages ----------------------------------------------------------------


def test_a_step_is_warned_of_once_and_again_when_a_message_replaces_it():
    run = play(walk(0.2, 1.4), seconds=0.2)

    def warned():
        return [
            (event.data["index"], event.data["about"])
            for event in run.events("warning")
        ]

    assert warned() == [(2, "place")]
    run.sim.publish(walk(0.2, 1.4))
    run.advance(0.1)
    assert warned() == [(2, "place")]
    run.sim.publish(walk(0.2, 1.5))
    run.advance(0.1)
    assert warned() == [(2, "place"), (2, "place")]


@pytest.mark.slow
def test_a_message_that_changes_the_first_foot_shifts_the_weight_anew():
    run = play(walk(0.2, 0.2), seconds=0.4)
    other = walk(0.2, 0.2)
    for data, foot in zip(other.walk_params.step_queue, (RIGHT, LEFT), strict=False):
        data.foot_index, data.pose.position.y = foot, 0.12 * SIDE[foot]
    run.sim.publish(other)
    changed = run.sim.time
    run.until(is_stepping(1))
    assert run.sim.time - changed == pytest.approx(TIMING.first_shift, abs=0.05)
    run.until(stands)
    landings = [step.data for step in run.events("footstep")]
    assert [step["foot"] for step in landings] == [RIGHT, LEFT]
    assert max(step["error_m"] for step in landings) < 0.01


def test_steps_of_a_message_end_the_demonstration():
    run = play(walk(demo=True), seconds=0.2)
    demo = run.sim.record.footsteps
    assert len(demo) > 2
    run.sim.publish(walk(demo=True))
    run.advance(0.1)
    assert [s.index for s in run.sim.record.footsteps] == [s.index for s in demo]
    run.sim.publish(walk(0.1))
    run.advance(0.1)
    assert [step.index for step in run.sim.record.footsteps] == [1]


# ---- pushes on the feet --------------------------------------------------------


def in_place():
    """A walk in place whose right foot is in the air."""
    run = play(walk(0.0, 0.0, 0.0, 0.0), seconds=0.1)
    run.until(is_stepping(2))
    return run


def tilt(orientation):
    _, x, y, _ = orientation
    return math.acos(1.0 - 2.0 * (x * x + y * y))


@pytest.mark.slow
def test_a_sole_that_a_push_has_turned_has_not_landed():
    run = in_place()
    run.until(lambda record: record.walk.t_step_rem < 0.14)
    run.sim.apply_push("r_foot", [0.0, 400.0, 300.0], 0.08)
    run.until(lambda record: not in_air(record))
    record = run.sim.record
    assert tilt(record.feet.right_orientation) < math.acos(RULES.landing_upright)
    run.until(stands)


@pytest.mark.slow
@pytest.mark.parametrize("kick", [[0.0, 0.0, 850.0], [-190.0, -200.0, 650.0]])
def test_a_foot_that_is_kicked_off_the_ground_swings_back_and_the_walk_goes_on(kick):
    run = in_place()
    run.until(lambda record: not in_air(record))
    kicked = run.sim.time
    run.sim.apply_push("r_foot", kick, 0.08)
    run.until(stands)
    heights = {
        record.time: record.feet.right_position[2]
        for record in run.records
        if kicked < record.time < kicked + 0.5
    }
    assert max(heights.values()) > 0.1
    assert heights[max(heights)] < 0.005
    landings = [
        (step.data["index"], step.data["foot"]) for step in run.events("footstep")
    ]
    assert landings == [(1, LEFT), (2, RIGHT), (2, RIGHT), (3, LEFT), (4, RIGHT)]
    assert run.events("footstep")[-1].data["error_m"] < 0.01


@pytest.mark.slow
def test_after_a_catch_the_feet_come_together_on_the_way_to_rest():
    run = play(seconds=0.5)
    force = 0.8 * run.sim.robot.mass / 0.1
    run.sim.apply_push("trunk", [force, 0.0, 0.0], 0.1)
    run.advance(0.5)
    run.until(stands)
    assert run.sim.time < 4.5
    first, second, _ = run.events("footstep")
    assert second.time - first.time < 1.5 * CONFIG.limits.duration.least

    def apart(event):
        left, right = run.at(event.time).feet.positions
        return math.hypot(*(left - right)[:2])

    assert apart(first) > 0.5
    width = CONFIG.in_place.width * StanceConfig().width
    assert apart(second) == pytest.approx(width, abs=0.02)


@pytest.mark.slow
def test_the_last_step_after_a_catch_puts_the_feet_side_by_side():
    # Quick steps until the robot is quiet, and then one with the usual time.
    run = play(seconds=0.5)
    per_speed = run.sim.robot.mass / 0.1
    run.sim.apply_push("trunk", [0.5 * per_speed, 0.5 * per_speed, 0.0], 0.1)
    run.advance(0.5)
    run.until(stands)
    *_, before, last = run.events("footstep")
    assert last.time - before.time > 1.2 * CONFIG.limits.duration.least
    left, right = run.sim.record.feet.positions
    width = StanceConfig().width
    away = (left - right)[:2] - [0.0, width]
    assert math.hypot(*away) < RULES.feet_apart


@pytest.mark.slow
def test_a_robot_that_a_push_tips_over_one_foot_keeps_its_height():
    # The other foot leaves the ground; it is pressed back, and carries the next step.
    run = play(seconds=0.5)
    force = 0.85 * run.sim.robot.mass / 0.1 * np.array([-0.34, -0.94, 0.0])
    run.sim.apply_push("trunk", force.tolist(), 0.1)
    run.advance(0.5)
    run.until(stands)
    assert len(run.events("footstep")) > 1
    height = min(record.balance.com[2] for record in run.records)
    assert height > 0.8 * run.sim.robot.com_height


@pytest.mark.slow
@pytest.mark.parametrize("late", [0.0, 0.24])
def test_a_push_back_at_both_shoulders_is_borne(late):
    """The waist holds the chest, which would turn to its stop and take all with it."""
    run = in_place()
    run.advance(late)
    force = -1.1 * run.sim.robot.mass / 0.1
    for shoulder in ("l_clav", "r_clav"):
        run.sim.apply_push(shoulder, [0.5 * force, 0.0, 0.0], 0.1)
    run.advance(0.5)
    run.until(stands)
