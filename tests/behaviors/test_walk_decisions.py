"""Decisions of WALK about its phases, without a simulation."""

import math

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand
from atlas_drake.behaviors.balance import StanceConfig
from atlas_drake.behaviors.body_reference import capture_body
from atlas_drake.behaviors.phases import TIME_STEP
from atlas_drake.behaviors.walk.both_feet import is_dcm_lost, steps_left_out
from atlas_drake.behaviors.walk.config import WalkConfig, WalkRules
from atlas_drake.behaviors.walk.gait import stance_cop
from atlas_drake.behaviors.walk.phases import (
    FinalTransfer,
    InitialTransfer,
    Transfer,
    WalkSwing,
)
from atlas_drake.behaviors.walk.walk import Walk
from atlas_drake.control.balance.foothold import WHOLE, Foothold
from atlas_drake.control.balance.step_adjustment import StepAdjustmentLimits
from atlas_drake.control.feet.footstep import outward
from atlas_drake.control.feet.sole_motion import Pitch, pitch_from
from atlas_drake.control.gains import ControlGains
from atlas_drake.control.whole_body import ComTask
from atlas_drake.frozen import replace
from atlas_drake.messages.footstep import LEFT, RIGHT, UP, FootPose
from atlas_drake.rotations import rotation_z
from atlas_drake.support_polygon import SupportPolygon
from atlas_drake.units import GRAVITY

from .conftest import as_request

RULES = WalkRules(
    touchdown_force=0.08,
    landing_force=0.01,
    landing_turn=0.03,
    earliest_touchdown=0.75,
    unload_share=0.4,
    dcm_ready=0.035,
    longest_wait=0.25,
    straight_flexion=0.12,
    frozen_end=0.06,
    rest_speed=0.08,
    transfer_change=0.40,
)
"""The defaults, in numbers: another default is another walk."""


@pytest.fixture(scope="module")
def walk(make_tools, observe):
    terms = observe().terms
    height = float(terms.com[2] - terms.feet[0].p_WF[2]) - StanceConfig().com_drop
    return Walk(make_tools(height), WalkConfig())


@pytest.fixture(scope="module")
def weight(robot):
    """Of the robot [N]."""
    return robot.mass * GRAVITY


def raised(pose, height):
    return FootPose(pose.p_WF + np.array([0.0, 0.0, height]), pose.R_WF)


@pytest.mark.parametrize("height", [0.0, 0.15], ids=["as planned", "lower"])
def test_a_step_too_high_from_the_feet_at_lift_off_ends_the_walk(
    walk, observe, walk_message, height
):
    seen, request = observe(), as_request(walk_message((1, 0, 0.2, 0.14)))
    body = capture_body(seen.terms)
    phase = walk.enter(seen, body, request)
    # The walk last saw the feet level with the step; since, they have come down.
    feet = tuple(raised(foot, height) for foot in phase.progress.feet)
    (step,) = phase.progress.pending
    place = np.array([*step.p_WF[:2], feet[1].p_WF[2]])
    pending = (replace(step, p_WF=place),)
    phase = replace(
        phase,
        elapsed=phase.duration + RULES.longest_wait,
        progress=replace(phase.progress, feet=feet, pending=pending),
    )
    outcome = walk.update(phase, seen, body, request, leaving=False)
    if height == 0.0:
        assert isinstance(outcome.state, WalkSwing)
        return
    assert isinstance(outcome.state, FinalTransfer)
    assert outcome.state.obstacle == "step 1 leads 0.15 m up, which is too much"
    (event,) = outcome.events
    assert event.text.startswith("WALK will end before step 1")


def bent(seen, robot, flexion):
    """The same look with both knees so far from the straight leg [rad]."""
    q = seen.terms.q.copy()
    for leg in robot.legs:
        q[leg.knee] = leg.straight + flexion
    return replace(seen, terms=replace(seen.terms, q=q))


def shifting(walk, seen, request, elapsed):
    phase = walk.enter(seen, capture_body(seen.terms), request)
    return replace(phase, elapsed=elapsed, plan_time=elapsed)


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize(
    ("late", "ready", "flexion", "lifts"),
    [
        (-0.01, True, 0.5, False),
        (0.0, True, 0.5, True),
        (0.0, False, 0.5, False),
        (RULES.longest_wait - 0.01, False, 0.5, False),
        (RULES.longest_wait + 0.01, False, 0.5, True),
        # A straight leg holds the pelvis back: waiting brings the DCM no nearer.
        (0.0, False, RULES.straight_flexion + 0.01, False),
        (0.0, False, RULES.straight_flexion - 0.01, True),
    ],
)
def test_lift_off_waits_for_the_dcm_but_not_with_a_straight_leg(
    walk, observe, robot, walk_message, foot, late, ready, flexion, lifts
):
    request = as_request(walk_message((1, foot, 0.2, 0.14 * outward(foot))))
    phase = shifting(walk, observe(), request, 0.0)
    phase = replace(phase, elapsed=phase.duration + late, plan_time=phase.duration)
    miss = (0.5 if ready else 1.5) * RULES.dcm_ready * np.array([0.6, 0.8])
    seen = bent(observe(above=phase.planned.dcm + miss), robot, flexion)
    after, _ = walk.control(phase).advance(phase, seen, False)
    assert isinstance(after, WalkSwing) == lifts
    if lifts:
        assert after.step.foot == foot
        swing = WalkConfig().timing.swing(after.sent.duration)
        assert after.duration == pytest.approx(swing - min(late, seen.dt))
    else:
        # The plan stands still while lift-off waits.
        held = 0.0 if late < 0.0 else seen.dt
        assert after.plan_time == pytest.approx(phase.plan_time - held)


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_the_foot_that_lifts_off_next_is_unloaded_evenly(
    walk, observe, walk_message, weight, foot
):
    seen = observe()
    request = as_request(walk_message((1, foot, 0.2, 0.14 * outward(foot))))
    phase = shifting(walk, seen, request, 0.0)

    def loads(share):
        now = replace(phase, elapsed=share * phase.duration)
        _, feet = walk.control(now).command_feet(now, seen)
        loads = [feet[side].contact.max_normal_force for side in (foot, 1 - foot)]
        return np.array(loads) / weight

    # The sole is trusted with so much before; none is left at lift-off.
    begins = 1.0 - RULES.unload_share
    trusted = loads(0.0)
    np.testing.assert_array_equal(loads(begins - 0.01), trusted)
    for share in (0.25, 0.5, 0.75):
        now = loads(begins + share * RULES.unload_share)
        np.testing.assert_allclose(now, [1.0 - share, trusted[1]])
    np.testing.assert_allclose(loads(1.0), [0.01, trusted[1]])
    # While lift-off waits both feet carry.
    np.testing.assert_array_equal(loads(1.01), trusted)


@pytest.fixture
def swinging(walk, observe, walk_message):
    """Makes a swing of ``foot`` after ``elapsed`` [s]."""

    def make(foot, elapsed):
        seen = observe()
        step = (1, foot, 0.2, 0.14 * outward(foot))
        ahead = (2, 1 - foot, 0.4, -0.14 * outward(foot))
        begun = shifting(walk, seen, as_request(walk_message(step, ahead)), 0.0)
        phase = walk.planner.swing(begun.progress, 0.0)
        motion = replace(phase.motion, elapsed=elapsed)
        return replace(phase, elapsed=elapsed, plan_time=elapsed, motion=motion)

    return make


def adjusted(walk, phase, seen):
    """The swing after a tick in which balance may move its landing."""
    return walk.control(phase).command_feet(phase, seen)[0]


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize("left", [0.45, 0.3, 0.1])
@pytest.mark.parametrize("axis", [0, 1])
def test_a_moved_step_leaves_the_error_that_the_ankles_can_hold(
    walk, observe, swinging, foot, left, axis
):
    phase = swinging(foot, 0.0)
    omega, touchdown = phase.plan.omega, phase.duration
    phase = swinging(foot, touchdown - left)
    growth = math.exp(omega * left)
    limits = StepAdjustmentLimits()
    ankle = (limits.cop_forward, limits.cop_sideways)[axis]
    tolerated = (limits.tolerated_forward, limits.tolerated_sideways)[axis]
    held = ankle * (growth - 1.0) + tolerated
    error = np.zeros(2)
    # Ahead and outward, where there is room for the landing place to move.
    side = (1.0, outward(foot))[axis]
    error[axis] = side * (held + 0.02) / growth
    moved = adjusted(walk, phase, observe(above=phase.planned.dcm + error))
    change = moved.plan.evaluate(touchdown).dcm - phase.plan.evaluate(touchdown).dcm
    rest = error * growth - change
    assert rest[axis] == pytest.approx(side * held, abs=1e-6)
    assert rest[1 - axis] == pytest.approx(0.0, abs=1e-4)
    # What they can hold by themselves moves no step, nor does less than 2 mm.
    for sign in (-1.0, 1.0):
        for more, moves in ((-0.01, False), (0.0015, False), (0.0025, True)):
            final = sign * side * (held + more * phase.sensitivity)
            seen = observe(above=phase.planned.dcm + np.eye(2)[axis] * final / growth)
            moved = adjusted(walk, phase, seen)
            assert (moved.plan is not phase.plan) == moves


def test_a_dcm_is_lost_beyond_what_is_planned(walk, observe, walk_message):
    request = as_request(walk_message((1, LEFT, 0.2, 0.14)))
    phase = shifting(walk, observe(), request, 0.0)
    planned = phase.planned.dcm
    # The plan itself is 4 cm outside of this region.
    corners = np.array([[-1.0, -1.0], [-0.04, -1.0], [-0.04, 1.0], [-1.0, 1.0]])
    phase = replace(phase, support=SupportPolygon(planned + corners))
    for ahead, lost in ((-0.06, False), (0.0, False), (0.02, False), (0.04, True)):
        seen = observe(above=planned + np.array([ahead, 0.0]))
        assert is_dcm_lost(phase, seen, 0.03) == lost


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize("duration", [0.69, 0.71])
def test_a_tick_of_a_swing_moves_the_plan_on_and_the_foot_in_the_air(
    walk, observe, walk_message, swinging, foot, duration
):
    phase, seen = swinging(foot, 0.1), observe()
    phase = replace(phase, step=replace(phase.step, duration=duration))
    request = phase.progress.request
    outcome = walk.update(phase, seen, capture_body(seen.terms), request, False)
    assert outcome.state.plan_time == pytest.approx(phase.plan_time + seen.dt)
    # Left and right sole come first among the tasks; the other one alone carries.
    command = outcome.command
    assert [contact.frame for contact in command.contacts] == [
        command.tasks[1 - foot].frame
    ]
    assert command.tasks[foot].target[5] > 1.0
    # In a slow step the height of the center of mass does not yield.
    (height,) = [task for task in command.tasks if isinstance(task, ComTask)]
    weights = ControlGains().weights
    quick = duration <= RULES.quick_step
    expected = weights.com_height_quick if quick else weights.com_height
    assert height.weight[2] == expected


def test_the_landing_place_is_fixed_at_the_end_of_a_swing(walk, observe, swinging):
    for before, moves in ((0.01, True), (-0.01, False)):
        phase = swinging(LEFT, swinging(LEFT, 0.0).duration - RULES.frozen_end - before)
        seen = observe(above=phase.planned.dcm + np.array([0.3, 0.0]))
        moved = adjusted(walk, phase, seen)
        assert (moved.plan is not phase.plan) == moves


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize(
    ("left", "force", "touches"),
    [
        (0.3, 1.0, False),  # A stumble.
        (0.07, 1.1 * RULES.touchdown_force, True),
        (0.07, 0.9 * RULES.touchdown_force, False),
        # The ground is expected: a light touch counts.
        (0.01, 1.1 * RULES.landing_force, True),
        (0.01, 0.9 * RULES.landing_force, False),
    ],
)
def test_touchdown_is_felt_by_the_foot_in_the_air(
    walk, observe, swinging, weight, foot, left, force, touches
):
    phase = swinging(foot, swinging(foot, 0.0).duration - left)
    felt = np.zeros(2)
    felt[foot] = force * weight
    seen = replace(observe(), foot_force=felt)
    after, _ = walk.control(phase).advance(phase, seen, False)
    if not touches:
        assert after is phase
        return
    assert isinstance(after, Transfer)
    landed = seen.foot_pose(foot).p_WF
    np.testing.assert_array_equal(after.progress.feet[foot].p_WF, landed)
    np.testing.assert_array_equal(after.progress.aimed[foot].p_WF, phase.step.p_WF)
    for kept in ("feet", "aimed"):
        before, now = getattr(phase.progress, kept), getattr(after.progress, kept)
        assert now[1 - foot] is before[1 - foot]
    # The step after it touches down when it would have after a touchdown in time.
    transfer = WalkConfig().timing.transfer(phase.progress.pending[0].duration)
    assert after.duration == pytest.approx(
        transfer + min(left, RULES.transfer_change * transfer)
    )
    # The other foot's load says nothing.
    elsewhere = replace(seen, foot_force=felt[::-1].copy())
    assert walk.control(phase).advance(phase, elsewhere, False)[0] is phase


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize(
    ("left", "aimed", "turned", "touches"),
    [
        (0.01, 0.3, 1.1 * RULES.landing_turn, True),
        (0.01, 0.3, 0.9 * RULES.landing_turn, False),
        (0.07, 0.3, 1.1 * RULES.landing_turn, False),
        (0.01, -0.3, 1.1 * RULES.landing_turn, False),
    ],
)
def test_a_foot_on_its_toes_has_landed_when_the_ground_turns_it(
    walk, observe, swinging, foot, left, aimed, turned, touches
):
    phase = swinging(foot, swinging(foot, 0.0).duration - left)
    seen = replace(observe(), foot_force=np.zeros(2))
    now = pitch_from(seen.foot_pose(foot), UP)
    motion = replace(phase.motion, landing_pitch=aimed, pitch=Pitch(now + turned))
    phase = replace(phase, motion=motion)
    after, _ = walk.control(phase).advance(phase, seen, False)
    assert isinstance(after, Transfer) == touches


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_the_cop_stays_on_the_part_of_a_stance_sole_that_carries(
    walk, observe, swinging, foot
):
    phase, seen, stance = swinging(foot, 0.2), observe(), 1 - foot
    heel = np.array([[-0.1, 0.04], [-0.1, -0.04], [-0.02, -0.04], [-0.02, 0.04]])
    footholds = [WHOLE, WHOLE]
    footholds[stance] = Foothold(part=heel)
    seen = replace(seen, footholds=tuple(footholds))
    after = walk.control(phase).advance(phase, seen, False)[0]
    assert after.progress.feet[stance].part is heel
    commands = walk.control(phase).command_feet(after, seen)[1]
    np.testing.assert_array_equal(commands[stance].contact.patch.corners, heel)
    middle = seen.terms.feet[stance].p_WF[:2]
    outside = after.support.distance_outside(middle)
    assert outside == pytest.approx(0.02, abs=1e-3)
    assert phase.support.distance_outside(middle) < 0.0


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_walk_is_over_when_the_robot_has_come_to_rest(
    walk, observe, walk_message, axis
):
    seen = observe()
    begun = shifting(walk, seen, as_request(walk_message()), 0.0)
    settle = walk.planner.final_transfer(begun.progress, begun.planned.cop)
    end = settle.duration + WalkConfig().timing.rest
    for late, speed, over in (
        (0.01, 0.9 * RULES.rest_speed, True),
        (0.01, 1.1 * RULES.rest_speed, False),
        (0.01, -1.1 * RULES.rest_speed, False),
        (-0.01, 0.0, False),
    ):
        velocity = np.zeros(3)
        velocity[axis] = speed
        now = replace(seen, terms=replace(seen.terms, com_velocity=velocity))
        phase = replace(settle, elapsed=end + late)
        assert walk.control(phase).is_over(phase, now) == over
    (event,) = steps_left_out(settle, 1.0, leaving=False)
    assert event.text.startswith("WALK ends without a step")
    # Nothing is left out if the end was asked for.
    assert steps_left_out(settle, 1.0, leaving=True) == ()


def test_a_step_may_be_warned_of_again_when_a_message_replaces_it(
    walk, observe, walk_message
):
    seen = observe()
    steps = [(1, LEFT, 0.2, 0.14), (2, RIGHT, 0.4, -0.14)]
    phase = shifting(walk, seen, as_request(walk_message(*steps)), 0.0)
    warned = frozenset({(1, "place"), (2, "place"), (2, "pace")})
    phase = replace(phase, progress=replace(phase.progress, warned=warned))
    body = capture_body(seen.terms)
    steps[1] = (2, RIGHT, 0.3, -0.14)
    request = as_request(walk_message(*steps))
    read = walk.update(phase, seen, body, request, leaving=False).state
    assert read.progress.warned == {(1, "place")}
    # A step out of reach is warned of when its message comes, and once.
    steps[1] = (2, RIGHT, 2.0, -0.14)
    request = as_request(walk_message(*steps))
    later = replace(phase, elapsed=0.1)
    outcome = walk.update(later, seen, body, request, leaving=False)
    assert [event.data["index"] for event in outcome.events] == [2]
    assert walk.update(outcome.state, seen, body, request, False).events == ()
    assert [step.p_WF[0] for step in read.progress.pending] == [0.2, 0.3]


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_the_plan_has_the_paths_of_swing_foot_com_dcm_and_cop(
    walk, observe, swinging, foot
):
    phase, seen = swinging(foot, 0.2), observe()
    # The body is where the plan wants it.
    omega, touchdown = phase.plan.omega, phase.duration
    plan = walk.plan(phase, phase.planned.dcm, omega)
    paths = walk.paths(phase, phase.planned.dcm, omega)
    np.testing.assert_array_equal(plan.dcm_reference, phase.planned.dcm)
    np.testing.assert_array_equal(plan.cop_reference, phase.planned.cop)
    under = stance_cop(phase.progress.feet, phase.step, WalkConfig())
    np.testing.assert_allclose(plan.cop_reference, under, atol=1e-9)
    assert [(step.foot, step.p_WF[0]) for step in plan.footsteps] == [
        (foot, 0.2),
        (1 - foot, 0.4),
    ]
    np.testing.assert_allclose(paths.swing[0], seen.foot_pose(foot).p_WF)
    np.testing.assert_allclose(paths.swing[-1], phase.step.p_WF, atol=2e-3)
    assert len(paths.swing) == pytest.approx(touchdown / TIME_STEP, abs=2.0)
    # ċ = ω(ξ - c) along the whole way, to rest between the feet.
    rate = np.diff(paths.com, axis=0) / TIME_STEP
    apart = paths.dcm - paths.com
    np.testing.assert_allclose(rate, omega * 0.5 * (apart[1:] + apart[:-1]), atol=5e-3)
    np.testing.assert_array_equal(paths.dcm[0], phase.planned.dcm)
    end = phase.plan.duration
    for path in (paths.com, paths.dcm, paths.cop):
        np.testing.assert_allclose(path[-1], phase.plan.evaluate(end).dcm, atol=0.03)


def test_every_plan_lasts_until_the_robot_is_at_rest(walk, observe, swinging):
    timing, swing = WalkConfig().timing, swinging(LEFT, 0.1)
    single, double = timing.swing(0.63), timing.transfer(0.63)
    begun = walk.planner.initial_transfer(
        swing.progress, swing.planned.dcm, swing.planned.cop
    )
    landed = walk.planner.land(swing.progress, swing.planned.cop, 0.0)
    over = walk.planner.final_transfer(
        replace(swing.progress, pending=()), swing.planned.cop
    )
    for phase, duration in (
        (begun, timing.first_shift + single + timing.settle),
        (swing, single + double + single + timing.settle),
        (landed, double + single + timing.settle),
        (over, timing.settle),
    ):
        assert phase.plan.duration == pytest.approx(duration)


def test_steps_that_come_while_the_robot_settles_are_taken(
    walk, observe, robot, swinging
):
    going, seen = swinging(LEFT, 0.1), observe()
    settle = walk.planner.final_transfer(going.progress, going.planned.cop)
    _, feet = walk.control(settle).command_feet(settle, seen)
    soles = [foot.sole_frame for foot in robot.file.feet]
    assert [foot.contact.frame for foot in feet] == soles
    again, _ = walk.control(settle).advance(settle, seen, False)
    assert isinstance(again, InitialTransfer)
    assert again.unloading == RIGHT
    np.testing.assert_allclose(again.planned.cop, settle.planned.cop)
    done = replace(settle, progress=replace(settle.progress, pending=()))
    assert walk.control(done).advance(done, seen, False) == (done, ())


def test_a_step_that_comes_in_the_swing_of_the_last_known_one_gets_a_weight_shift(
    walk, observe, swinging, walk_message
):
    known = swinging(LEFT, 0.1)
    assert not known.stops
    one = as_request(walk_message((1, LEFT, 0.2, 0.14)))
    last = walk.planner.swing(shifting(walk, observe(), one, 0.0).progress, 0.0)
    assert last.stops
    # The second step comes after the plan of the first one was made to come to rest.
    late = replace(last.progress, pending=known.progress.pending)
    for swing, kind in ((last, FinalTransfer), (known, Transfer)):
        landed = walk.planner.land(late, swing.planned.cop, 0.0, 0.0, swing.stops)
        assert isinstance(landed, kind)
    settle = walk.planner.land(late, last.planned.cop, 0.0, 0.0, True)
    again, _ = walk.control(settle).advance(settle, observe(), False)
    assert isinstance(again, InitialTransfer)
    assert again.unloading == RIGHT


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_a_request_to_stand_drops_the_steps_that_have_not_begun(
    walk, observe, swinging, foot
):
    swing, seen = swinging(foot, 0.1), observe()
    quiet = as_request(AtlasSimInterfaceCommand(behavior="STAND"))

    def leave(phase):
        body = capture_body(seen.terms)
        outcome = walk.update(phase, seen, body, quiet, leaving=True)
        assert outcome.state.progress.pending == ()
        assert not outcome.finished
        return outcome.state

    # A foot in the air lands first; with both feet down the robot settles.
    assert isinstance(leave(swing), WalkSwing)
    landed = walk.planner.land(swing.progress, swing.planned.cop, 0.0)
    begun = walk.planner.initial_transfer(
        swing.progress, swing.planned.dcm, swing.planned.cop
    )
    for phase in (landed, begun):
        assert isinstance(leave(phase), FinalTransfer)


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_the_body_rises_and_turns_with_either_foot(walk, observe, walk_message, foot):
    seen, request = observe(), as_request(walk_message())
    body = capture_body(seen.terms)
    phase = walk.enter(seen, body, request)
    feet = list(phase.progress.feet)
    feet[foot] = FootPose(raised(feet[foot], 0.1).p_WF, rotation_z(0.3))
    phase = replace(phase, progress=replace(phase.progress, feet=tuple(feet)))
    level = walk.update(walk.enter(seen, body, request), seen, body, request, False)
    after = walk.update(phase, seen, body, request, leaving=False)
    assert after.body.height > level.body.height
    assert after.body.yaw > level.body.yaw


def test_steps_of_a_message_end_the_demonstration(walk, observe, walk_message):
    seen = observe()
    demo = walk_message()
    demo.walk_params.use_demo_walk = True
    first = as_request(demo)
    phase = walk.enter(seen, capture_body(seen.terms), first)
    assert len(phase.progress.pending) > 2
    again = as_request(demo)
    body = capture_body(seen.terms)
    kept = walk.update(phase, seen, body, again, leaving=False).state
    assert kept.progress.pending == phase.progress.pending
    own = as_request(walk_message((1, 0, 0.1, 0.14)))
    read = walk.update(phase, seen, body, own, leaving=False).state
    assert [step.index for step in read.progress.pending] == [1]
