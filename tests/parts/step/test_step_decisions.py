"""Decisions of STEP about weight shift and loads, without a simulation."""

import dataclasses
import math

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand
from atlas_drake.behaviors.body_reference import capture_body
from atlas_drake.behaviors.phases import TIME_STEP
from atlas_drake.control.balance import feedback
from atlas_drake.control.feet.footstep import outward
from atlas_drake.control.feet.sole_motion import pitched_pose
from atlas_drake.frozen import replace
from atlas_drake.messages import NO_STEP, StepStatus, Vector3
from atlas_drake.messages.event import FOOTSTEP, STEPS_LEFT
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose
from atlas_drake.parts.step.config import StepConfig, StepRules
from atlas_drake.parts.step.phases import (
    Lower,
    Rest,
    StepSettle,
    StepShift,
    StepSwing,
)
from atlas_drake.parts.step.step import Step
from atlas_drake.parts.step.weight_shift import WeightShift
from atlas_drake.rotations import rotation_z
from tests.parts.conftest import as_request

RULES = StepRules(
    touchdown_force=0.04,
    settle=0.25,
    settling_load=0.06,
    unload_share=0.35,
    still_loaded=0.10,
    dcm_ready=0.02,
    cop_inside=0.01,
    longest_wait=0.3,
    lean_inside=0.025,
    rest_speed=0.05,
)
"""The defaults, in numbers: another default is another step."""


@pytest.fixture(scope="module")
def step(make_tools, balance, observe):
    terms = observe().terms
    height = float(terms.com[2] - terms.feet[LEFT].p_WF[2])
    return Step(make_tools(height - balance.stance.com_drop), StepConfig())


def request(index=1, foot=LEFT, x=0.15, z=0.0):
    command = AtlasSimInterfaceCommand(behavior="STEP")
    command.step_params.use_spec = True
    command.step_params.use_relative_step_height = True
    spec = command.step_params.desired_step_spec
    spec.step_index, spec.foot_index = index, foot
    spec.foot.position = Vector3(x, 0.14 * outward(foot), z)
    return as_request(command)


def entered(step, seen, command):
    return step.enter(seen, capture_body(seen.terms), command)


def tick(step, state, seen, command, leaving=False):
    return step.update(state, seen, capture_body(seen.terms), command, leaving)


def shifting(step, seen, command):
    outcome = tick(step, entered(step, seen, command), seen, command)
    assert isinstance(outcome.state, StepShift)
    return outcome.state


def dcm(seen, balance):
    height = float(seen.terms.com[2] - seen.terms.feet[0].p_WF[2])
    return feedback.dcm(seen.terms, feedback.pendulum_frequency(height))


@pytest.mark.parametrize("speed", [0.0, 0.12, -0.12])
def test_a_weight_shift_starts_where_the_robot_is_and_how_it_moves(
    step, observe, balance, speed
):
    seen, command = observe(speed=speed), request()
    state = entered(step, seen, command)
    assert (state.shift_time, state.elapsed, state.lean) == (0.0, 0.0, 0.0)
    np.testing.assert_allclose(state.shift.start, dcm(seen, balance), atol=0.002)
    middle = 0.5 * (seen.terms.feet[LEFT].p_WF + seen.terms.feet[RIGHT].p_WF)[:2]
    np.testing.assert_allclose(state.shift.end, middle)
    state = shifting(step, seen, command)
    np.testing.assert_allclose(state.shift.start, dcm(seen, balance), atol=0.002)
    on = tick(step, state, seen, command).state
    assert on.shift_time == on.elapsed == seen.dt
    # Over the right foot, a centimetre short of its middle.
    right = seen.terms.feet[RIGHT].p_WF
    np.testing.assert_allclose(
        state.shift.end, right[:2] + np.array([0.0, 0.01]), atol=0.001
    )


@pytest.mark.parametrize(("tilt", "less"), [(0.2, None), (0.45, "0.20")])
def test_a_slope_that_is_too_steep_gives_a_warning(step, observe, tilt, less):
    seen, command = observe(), request()
    normal = Vector3(math.sin(tilt), 0.0, math.cos(tilt))
    command.command.step_params.desired_step_spec.foot.normal = normal
    outcome = tick(step, entered(step, seen, command), seen, command)
    assert isinstance(outcome.state, StepShift)
    told = [] if less is None else [f"step 1 is tilted {less} rad less than its normal"]
    assert [event.text for event in outcome.events] == told


@pytest.mark.parametrize(("z", "taken"), [(0.20, True), (0.205, True), (0.22, False)])
def test_a_rise_at_the_limit_is_taken_despite_rounding_of_the_soles_height(
    step, observe, z, taken
):
    command = request(x=0.3, z=z)
    seen = observe()
    outcome = tick(step, entered(step, seen, command), seen, command)
    assert isinstance(outcome.state, StepShift) == taken
    assert ("out of reach" in str(outcome.events)) != taken


def test_a_foot_is_lifted_no_higher_than_its_leg_folds(step, observe):
    command = request(x=0.1)
    action = command.command.step_params.desired_step_spec.action
    action.lift_height = action.swing_height = 0.2
    action.knee_nominal = 0.9
    taken = shifting(step, observe(), command).step
    assert 0.1 < taken.action.lift_height <= 0.2
    rise = taken.action.lift_height + taken.action.swing_height
    assert rise < 0.35
    assert taken.swing_height == pytest.approx(rise, abs=0.01)


@pytest.mark.parametrize("speed", [0.45, -0.45])
def test_no_weight_shift_begins_while_the_robot_tips(step, observe, speed):
    seen, command = observe(speed=speed), request()
    outcome = tick(step, entered(step, seen, command), seen, command)
    assert isinstance(outcome.state, Rest)
    # The step is not lost: it begins when the robot has come to rest.
    assert outcome.events == ()
    later = tick(step, outcome.state, observe(), command)
    assert isinstance(later.state, StepShift)
    assert later.state.progress.index == 1


@pytest.mark.parametrize("speed", [0.45, -0.45])
def test_a_weight_shift_is_abandoned_when_the_robot_tips(step, observe, speed):
    command = request()
    state = shifting(step, observe(), command)
    steady = tick(step, state, observe(), command)
    assert isinstance(steady.state, StepShift)
    assert steady.events == ()
    outcome = tick(step, state, observe(speed=speed), command)
    assert isinstance(outcome.state, Rest)
    (event,) = outcome.events
    assert event.kind == STEPS_LEFT
    assert "step 1 is not taken: its foot cannot be unloaded" in event.text
    # The next step waits until the weight is back between the feet.
    second = request(2)
    waits = tick(step, outcome.state, observe(), second)
    assert isinstance(waits.state, Rest)
    back = replace(outcome.state, elapsed=outcome.state.shift.duration)
    begins = tick(step, back, observe(), second)
    assert isinstance(begins.state, StepShift)
    assert begins.state.progress.index == 2


def test_a_step_whose_foot_stays_loaded_is_abandoned(step, observe):
    command = request()
    state = shifting(step, observe(), command)
    end = state.shift.duration + RULES.longest_wait
    waits = tick(step, replace(state, elapsed=end - 0.01), observe(), command)
    assert isinstance(waits.state, StepShift)
    gives_up = tick(step, replace(state, elapsed=end), observe(), command)
    assert isinstance(gives_up.state, Rest)
    assert gives_up.events[-1].kind == STEPS_LEFT


def standing_still_at(state, place, duration=1.0, **fields):
    """The state with a weight shift that is at ``place`` from now on."""
    shift = WeightShift(place, place, duration)
    return replace(state, shift=shift, shift_time=duration, **fields)


def in_phase(kind, state, **fields):
    """The same step in another phase."""
    if kind is Rest:
        fields["last"] = state.step
    elif kind is StepSettle:
        fields["went_back"] = False
    names = {field.name for field in dataclasses.fields(kind)}
    kept = {name: value for name, value in vars(state).items() if name in names}
    return kind(**{**kept, **fields})


def commanded(step, state, seen):
    """Both feet's contacts; the reference is held still for the look."""
    _, feet = step.control(state).command_feet(state, seen)
    return [foot.contact for foot in feet]


@pytest.mark.parametrize("pressed", [LEFT, RIGHT])
def test_a_foot_is_pressed_flat_only_as_far_as_balance_allows(
    step, observe, balance, pressed
):
    seen = observe()
    state = shifting(step, seen, request(foot=pressed))
    here = dcm(seen, balance)
    state = in_phase(StepSettle, state)
    settling = standing_still_at(state, here)
    feet = commanded(step, settling, seen)
    least = RULES.settling_load * balance.weight
    assert feet[pressed].min_normal_force == pytest.approx(least)
    assert feet[1 - pressed].min_normal_force == 0.0
    # The CoP is desired at the outer edge of the other foot: no load on this one.
    away = seen.terms.feet[pressed].p_WF[:2] - here
    settling = standing_still_at(state, here + away)
    feet = commanded(step, settling, seen)
    assert feet[pressed].min_normal_force == pytest.approx(0.0, abs=1e-6)


def test_a_foot_that_landed_is_pressed_in_the_first_part_of_the_shift(step, observe):
    seen = observe()
    rest = entered(step, seen, request())
    rest = replace(rest, shift=replace(rest.shift, duration=2.0), touchdown_foot=LEFT)
    for share, pressed in ((0.35, True), (0.45, False)):
        feet = commanded(step, replace(rest, shift_time=2.0 * share), seen)
        assert (feet[LEFT].min_normal_force > 0.0) == pressed
        assert feet[RIGHT].min_normal_force == 0.0


def test_an_unloaded_foot_is_loaded_again_when_the_cop_needs_it(step, observe, balance):
    seen = observe()
    state = shifting(step, seen, request(foot=LEFT))
    here, left = dcm(seen, balance), seen.terms.feet[LEFT].p_WF[:2]
    right = seen.terms.feet[RIGHT].p_WF[:2]
    # The CoP has to come back to it at the end of its weight shift.
    done = {"elapsed": state.shift.duration, "heel": 0.0}
    ill = standing_still_at(state, here + 0.25 * (right - here), **done)
    feet = commanded(step, ill, seen)
    low = feet[LEFT].max_normal_force / balance.weight
    assert 0.4 < low < 0.9
    assert np.linalg.norm(left - right) > 0.2


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize("duration", [0.5, 2.0])
def test_the_leaving_foot_is_unloaded_evenly_until_lift_off(
    step, observe, balance, foot, duration
):
    state = shifting(step, observe(), request(foot=foot))
    stance = state.feet[1 - foot].p_WF[:2]
    for left in (0.75, 0.5, 0.25):
        elapsed = duration * (1.0 - left * RULES.unload_share)
        still = {"elapsed": elapsed, "heel": 0.0, "touchdown_foot": None}
        state = standing_still_at(state, stance, duration, **still)
        feet = commanded(step, state, observe(above=stance))
        loads = [feet[side].max_normal_force for side in (foot, 1 - foot)]
        assert loads[0] == pytest.approx(left * balance.weight)
        assert loads[1] > 0.8 * balance.weight


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_a_foot_that_touches_down_is_pressed_flat_and_gives_an_event(
    step, observe, balance, foot
):
    command = request(foot=foot)
    state = shifting(step, observe(), command)
    lowering = in_phase(Lower, state, elapsed=0.9 * state.swing.duration)
    force = np.zeros(2)
    for side, share, kind in (
        (foot, 0.9, Lower),
        (1 - foot, 5.0, Lower),
        (foot, 1.1, StepSettle),
    ):
        force[:] = 0.0
        force[side] = share * RULES.touchdown_force * balance.weight
        seen = replace(observe(pitch=0.05), foot_force=force)
        settling = tick(step, lowering, seen, command).state
        assert isinstance(settling, kind)
    assert settling.feet[1 - foot] is state.feet[1 - foot]
    landed = seen.foot_pose(foot).p_WF
    np.testing.assert_array_equal(settling.feet[foot].p_WF, landed)
    done = replace(settling, elapsed=RULES.settle)
    outcome = tick(step, done, observe(), command)
    assert isinstance(outcome.state, Rest)
    assert (outcome.state.touchdown_foot, outcome.state.lean) == (foot, 0.0)
    (event,) = outcome.events
    at_rest = observe().foot_pose(foot).p_WF
    miss = 1e3 * np.hypot(*(at_rest - state.step.p_WF)[:2])
    side = ("left", "right")[foot]
    assert event.kind == FOOTSTEP
    assert event.text == f"step 1 landed ({side}, {miss:.0f} mm off)"
    assert tick(step, replace(done, went_back=True), observe(), command).events == ()


def time_left(step, state):
    return step.feedback(state, 0).t_step_rem


def test_the_time_left_counts_to_the_end_of_the_step_in_every_phase(step, observe):
    state = shifting(step, observe(), request())
    shift, swing = state.shift.duration, state.swing.duration
    settle = RULES.settle
    for phase, elapsed, left in (
        (StepShift, 0.0, shift + swing + settle),
        (StepShift, shift, swing + settle),
        (StepShift, shift + 0.2, swing + settle),
        (StepSwing, 0.0, swing + settle),
        (Lower, 0.75 * swing, 0.25 * swing + settle),
        (Lower, swing + 0.3, settle),
        (StepSettle, 0.0, settle),
        (StepSettle, 0.1, settle - 0.1),
        (StepSettle, settle + 0.1, 0.0),
        (Rest, 0.1, 0.0),
    ):
        now = in_phase(phase, state, elapsed=elapsed)
        assert time_left(step, now) == pytest.approx(left), (phase, elapsed)


def test_without_a_step_the_robot_waits_in_double_support(step, observe):
    command = as_request(AtlasSimInterfaceCommand(behavior="STEP"))
    state = entered(step, observe(), command)
    outcome = tick(step, replace(state, elapsed=9.0), observe(), command)
    assert isinstance(outcome.state, Rest)
    feedback = step.feedback(outcome.state, outcome.status_flags)
    assert (feedback.current_step_index, feedback.next_step_index_needed) == (0, 1)
    assert feedback.status_flags == StepStatus.SUBSTATE_SWAYING
    assert feedback.desired_step_saturated.step_index == NO_STEP
    assert tick(step, state, observe(), command, leaving=True).finished


def test_the_event_at_the_end_names_the_steps_left_out(step, observe):
    seen, command = observe(), request()
    state = shifting(step, seen, command)
    outcome = tick(step, state, seen, command, leaving=True)
    assert outcome.finished
    (event,) = outcome.events
    assert (event.kind, event.text) == (STEPS_LEFT, "STEP ends without the step 1")
    # And the next one, if it was asked for already.
    (event,) = tick(step, state, seen, request(2), leaving=True).events
    assert event.text == "STEP ends without the steps 1, 2"
    # After a step that is done there is nothing to say.
    done = in_phase(Rest, state)
    assert tick(step, done, seen, command, leaving=True).events == ()


def test_the_body_sinks_with_a_foot_that_finds_no_ground(step, observe):
    state = shifting(step, observe(), request())
    goal, swing = state.step.pose, state.swing
    lowering = in_phase(Lower, state, elapsed=0.8 * swing.duration)
    foothold = lowering.foothold()
    np.testing.assert_array_equal(foothold.p_WF, goal.p_WF)
    late = replace(lowering, elapsed=swing.duration + 0.3)
    foothold = late.foothold()
    assert goal.p_WF[2] - foothold.p_WF[2] > 0.02
    np.testing.assert_array_equal(foothold.p_WF[:2], goal.p_WF[:2])


def raised(state, foot, rise):
    """The state with one foot higher up."""
    feet = list(state.feet)
    p_WF = feet[foot].p_WF + np.array([0.0, 0.0, rise])
    feet[foot] = FootPose(p_WF, feet[foot].R_WF)
    return replace(state, feet=tuple(feet))


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_at_rest_the_body_is_half_way_between_the_feet(step, observe, foot):
    state = entered(step, observe(), request())

    def height(state):
        reach = step.control(state).reach(state)
        return step.tools.body_target(state, reach).height

    level = height(state)
    up = height(raised(state, foot, 0.01))
    assert up == pytest.approx(level + 0.005)
    # Its heading is between theirs, too.
    feet = list(state.feet)
    feet[foot] = FootPose(feet[foot].p_WF, rotation_z(0.2))
    turned = replace(state, feet=tuple(feet))
    target = step.tools.body_target(turned, step.control(turned).reach(turned))
    assert target.yaw == pytest.approx(0.1, abs=1e-3)


@pytest.mark.parametrize("speed", [0.0, RULES.rest_speed + 0.01])
def test_a_step_cut_short_ends_at_rest(step, observe, speed):
    command = request()
    state = shifting(step, observe(), command)
    flying = in_phase(StepSwing, state, elapsed=0.1)
    assert not tick(step, flying, observe(), command, leaving=True).finished
    for elapsed in (-0.1, 0.1):
        landed = in_phase(Rest, state, elapsed=state.shift.duration + elapsed)
        cut_short = replace(landed, progress=replace(landed.progress, leaving=True))
        seen = observe(speed=-speed)
        finished = tick(step, cut_short, seen, command, leaving=True).finished
        assert finished == (elapsed > 0.0 and speed == 0.0)
        # If both feet are down anyway, STAND brings the robot to rest.
        assert tick(step, landed, seen, command, leaving=True).finished


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_the_plan_has_the_paths_of_swing_foot_com_dcm_and_cop(step, observe, foot):
    seen, command = observe(), request(foot=foot)
    state = shifting(step, seen, command)
    plan = step.plan(state, seen.terms.com[:2], 3.2)
    paths, shift = step.paths(state, seen.terms.com[:2], 3.2), state.shift
    assert plan.footsteps == ()
    assert paths.swing is None
    np.testing.assert_allclose(plan.dcm_reference, shift.start, atol=1e-9)
    for path in (paths.com, paths.dcm, paths.cop):
        np.testing.assert_allclose(path[0], shift.start, atol=1e-3)
        np.testing.assert_allclose(path[-1], shift.end, atol=0.01)
    # ξ = c + ċ/ω, along the whole way.
    rate = np.gradient(paths.com, TIME_STEP, axis=0)[1:-1]
    ahead = (paths.dcm - paths.com)[1:-1]
    np.testing.assert_allclose(ahead, rate / 3.2, atol=2e-3)
    flying = in_phase(StepSwing, state, elapsed=0.1)
    plan = step.plan(flying, seen.terms.com[:2], 3.2)
    (target,) = plan.footsteps
    assert (target.foot, target.yaw) == (foot, state.step.yaw)
    swing = step.paths(flying, seen.terms.com[:2], 3.2).swing
    duration = state.swing.duration
    assert len(swing) == pytest.approx(duration / TIME_STEP, abs=1.0)
    np.testing.assert_allclose(swing[0][:2], state.feet[foot].p_WF[:2], atol=0.01)
    np.testing.assert_allclose(swing[-1], target.p_WF, atol=0.01)


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize(
    ("late", "load", "miss", "lifts"),
    [
        (-0.01, 0.0, 0.0, False),
        (0.0, 0.9, 0.9, True),
        (0.0, 1.1, 0.0, False),
        (0.0, 0.0, 1.1, False),
    ],
)
def test_a_foot_lifts_off_without_load_when_the_weight_is_over_the_other(
    step, observe, balance, foot, late, load, miss, lifts
):
    command = request(foot=foot)
    state = shifting(step, observe(), command)
    state = replace(state, elapsed=state.shift.duration + late)
    away = miss * RULES.dcm_ready * np.array([0.8, -0.6])
    seen = observe(above=state.shift.end + away)
    felt = np.full(2, balance.weight)
    felt[foot] = load * RULES.still_loaded * balance.weight
    after = tick(step, state, replace(seen, foot_force=felt), command).state
    assert isinstance(after, StepSwing) == lifts
    if lifts:
        alone = balance.support(state.feet[1 - foot])
        np.testing.assert_array_equal(after.support.vertices, alone.vertices)


def test_the_heel_rises_smoothly_in_the_last_part_of_the_shift(step, observe):
    state = replace(shifting(step, observe(), request()), heel=0.3)
    begins, end, dt = 0.5 * state.shift.duration, state.shift.duration, 1e-5

    def heel(time):
        return np.array(replace(state, elapsed=time).heel_motion(0.5))

    for time in (0.0, begins, end, end + 0.5):
        angle = 0.3 if time >= end else 0.0
        np.testing.assert_allclose(heel(time), [angle, 0.0, 0.0], atol=1e-9)
    for time in np.linspace(begins, end, 7)[1:-1]:
        slope = (heel(time + dt) - heel(time - dt)) / (2.0 * dt)
        np.testing.assert_allclose(heel(time)[1:], slope[:2], atol=1e-4)
        assert heel(time)[1] > 0.0
    assert not replace(state, heel=0.0).heel_motion(0.5)[0]
    # On its toes the foot still widens the support, but carries no moment.
    shift = step.control(state)
    flat, raised = (
        shift.support(replace(state, elapsed=time)) for time in (0.0, 0.9 * end)
    )
    length = np.array([0.1, 0.0])
    behind = state.feet[LEFT].p_WF[:2] - length
    ahead = state.feet[LEFT].p_WF[:2] + length
    assert flat.distance_outside(behind) < 0.0 < raised.distance_outside(behind)
    assert raised.distance_outside(ahead) < flat.distance_outside(ahead) + 0.05
    # The legs have to reach the sole as it is now, and raised in full at lift-off.
    rising = replace(state, elapsed=0.8 * end)
    reach, half = shift.reach(rising), step.tools.planner.half_length
    for pose, angle in (
        (reach.now[LEFT], rising.heel_motion(0.5)[0]),
        (reach.later[LEFT][1], 0.3),
    ):
        expected = pitched_pose(state.feet[LEFT], angle, half)
        np.testing.assert_allclose(pose.p_WF, expected.p_WF, atol=1e-12)
    # Its contact moves to the toes while the heel is up.
    whole, toes = (
        commanded(step, replace(state, elapsed=time, touchdown_foot=None), observe())[
            LEFT
        ]
        for time in (0.0, 0.9 * end)
    )
    assert whole.patch.corners[:, 0].min() < -0.05
    assert toes.patch.corners[:, 0].min() > 0.05
    assert shift.are_both_flat(replace(state, elapsed=begins))
    for elapsed in (0.9 * end, end):
        now = replace(state, elapsed=elapsed)
        assert not shift.are_both_flat(now)
        assert shift.support(now).distance_outside(behind) > 0.0


@pytest.fixture
def lowered(step, observe):
    """Makes the phase in which ``foot`` comes down and the body leans [m]."""

    def make(foot, lean):
        command = request(foot=foot)
        state = shifting(step, observe(), command)
        action = replace(state.step.action, step_end_dist=lean)
        rising = {"elapsed": 0.0, "step": replace(state.step, action=action)}
        stance = step.tools.balance.support(state.feet[1 - foot])
        swing = in_phase(StepSwing, state, **rising, support=stance)
        assert tick(step, swing, observe(), command).state.elapsed > 0.0
        above = replace(swing, elapsed=swing.swing.duration - swing.swing.lower)
        lower = tick(step, above, observe(), command).state
        assert isinstance(lower, Lower)
        return lower, command

    return make


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize("lean", [-0.02, -0.001, 0.0, 0.001, 0.02])
def test_the_body_leans_into_the_step_as_far_as_the_foot_can_bring_it_back(
    step, observe, lowered, foot, lean
):
    lower, _ = lowered(foot, lean)
    shift = lower.shift
    leant = shift.end - shift.start
    if lean == 0.0:
        assert np.hypot(*leant) > 0.05  # The whole weight shift before, unchanged.
        return
    assert lower.shift_time == 0.0
    assert shift.duration == lower.swing.lower
    way = lower.step.p_WF[:2] - lower.feet[1 - foot].p_WF[:2]
    ahead = way / np.hypot(*way)
    assert leant == pytest.approx((leant @ ahead) * ahead, abs=1e-9)
    share = (leant @ ahead) / lean

    def reserves(share):
        end = shift.start + share * lean * ahead
        omega = step.tools.omega(observe(), (lower.feet[1 - foot],))
        moved = WeightShift(shift.start, end, shift.duration)
        inside = -lower.support.distance_outside(end) - RULES.lean_inside
        return inside, -moved.cop_outside(lower.support, omega) - RULES.cop_inside

    # In tenths, and no more than the stance foot has room for.
    assert min(reserves(share)) >= -1e-9
    if abs(lean) < 0.01:
        assert share == pytest.approx(1.0)
    else:
        assert 0.0 < share < 1.0
        assert min(reserves(share + 0.1)) < 0.0


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize("lean", [0.0, 0.02])
def test_a_foot_that_finds_no_ground_returns_to_where_it_was(
    step, observe, lowered, foot, lean
):
    lower, command = lowered(foot, lean)
    times = np.arange(0.0, 3.0, 0.01) + lower.elapsed
    missed = next(time for time in times if lower.swing.has_missed(time))
    in_air = replace(observe(), foot_force=np.zeros(2))
    before = tick(step, replace(lower, elapsed=missed - 0.02), in_air, command)
    assert isinstance(before.state, Lower)
    outcome = tick(step, replace(lower, elapsed=missed), in_air, command)
    (event,) = outcome.events
    assert (event.kind, event.text) == (
        STEPS_LEFT,
        "step 1 found no ground; its foot returns",
    )
    back = outcome.state
    assert isinstance(back, StepSwing)
    assert (back.went_back, back.elapsed) == (True, 0.0)
    home, here = lower.feet[foot], in_air.foot_pose(foot)
    np.testing.assert_array_equal(back.step.p_WF, home.p_WF)
    assert back.step.yaw == pytest.approx(home.yaw)
    swing = back.swing
    np.testing.assert_allclose(swing.evaluate(0.0).p_WF, here.p_WF, atol=1e-9)
    landed = swing.evaluate(swing.duration).p_WF
    np.testing.assert_allclose(landed[:2], home.p_WF[:2], atol=1e-6)
    # The body goes back with it, from where it leant, and does not lean again.
    assert back.step.action.step_end_dist == 0.0
    if lean:
        np.testing.assert_allclose(back.shift.end, lower.shift.start)
        assert back.shift.duration >= swing.lower
    else:
        assert back.shift is lower.shift


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_a_new_foot_is_pressed_with_the_body_over_the_other(step, observe, foot):
    state = shifting(step, observe(), request(foot=foot))

    def height(state):
        return step.control(state).reach(state).height

    settling = in_phase(StepSettle, state)
    above = step.tools.planner.height(state.step.action)
    stance_z = settling.feet[1 - foot].p_WF[2]
    assert height(settling) == pytest.approx(stance_z + above)
    assert height(raised(settling, foot, 0.1)) == height(settling)
    higher = height(raised(settling, 1 - foot, 0.1))
    assert higher == pytest.approx(height(settling) + 0.1)


def test_each_message_is_a_new_step_whatever_its_index_but_not_its_repetition(
    step, observe
):
    seen, first = observe(), request(1)
    state = shifting(step, seen, first)
    assert step.tools.requested(state) is None
    # Many clients send the same message all the time.
    state = tick(step, state, seen, request(1)).state
    assert step.tools.requested(state) is None
    changed = tick(step, state, seen, request(1, foot=RIGHT)).state
    assert step.tools.requested(changed).foot == RIGHT
    again = tick(step, changed, seen, request(1, foot=RIGHT)).state
    assert step.tools.requested(again).foot == RIGHT
    withdrawn = tick(step, again, seen, request(NO_STEP)).state
    assert step.tools.requested(withdrawn) is None
