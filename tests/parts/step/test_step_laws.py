"""Laws of STEP, on the records of every tick."""

import math

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand
from atlas_drake.messages import NO_STEP, StepStatus, ToeOff, Vector3
from atlas_drake.messages.event import STEPS_LEFT
from atlas_drake.parts.step.config import StepConfig
from atlas_drake.rotations import rotation_matrix
from atlas_drake.units import GRAVITY
from tests.play import SIDE, loads, play, stands

RULES = StepConfig().rules
LEFT, RIGHT = 0, 1
NO_RECOVERY = {"stand": {"recovery_steps": False}}


def step(index=1, foot=LEFT, x=0.15, z=0.0, normal=(0.0, 0.0, 1.0), **action):
    """A STEP message of one step, with some values of its action."""
    command = AtlasSimInterfaceCommand(behavior="STEP")
    command.step_params.use_spec = True
    spec = command.step_params.desired_step_spec
    spec.step_index, spec.foot_index = index, foot
    spec.foot.position = Vector3(x, 0.14 * SIDE[foot], z)
    spec.foot.normal = Vector3.from_array(normal)
    for name, value in action.items():
        setattr(spec.action, name, value)
    return command


def rules(**values):
    """The controller with other rules of STEP."""
    return {"step": {"rules": values}}


def in_air(record):
    return record.step.status_flags == StepStatus.SUBSTATE_STEPPING


def is_done(index):
    """Whether this step is done."""

    def done(record):
        return record.step.current_step_index == index and record.step.t_step_rem == 0.0

    return done


def taken(message, index=1, **scenario):
    """A run until a step is done."""
    run = play(message, seconds=0.1, **scenario)
    run.until(is_done(index))
    return run


def soles(record):
    feet = record.feet
    return np.array([feet.left_position, feet.right_position])


def texts(run, kind=STEPS_LEFT):
    return [event.text for event in run.events(kind)]


@pytest.fixture(scope="module", params=[LEFT, RIGHT], ids=["left", "right"])
def one_step(request):
    """A step ahead, and the foot that takes it."""
    return taken(step(foot=request.param)), request.param


def phases(run):
    """The numbers of the records of lift-off and touchdown."""
    flying = [in_air(record) for record in run.records]
    begun = flying.index(True)
    return begun, begun + flying[begun:].index(False)


# ---- the weight shift --------------------------------------------------------


@pytest.mark.slow
def test_a_weight_shift_leads_from_the_robot_to_the_middle_of_the_stance_sole(one_step):
    run, foot = one_step
    begun, _ = phases(run)
    stepping = [r for r in run.records if r.step.current_step_index == 1]
    first, last = stepping[0].balance, run.records[begun - 1]
    np.testing.assert_allclose(first.dcm_reference, first.dcm, atol=0.005)
    # A centimetre short of its middle.
    end = soles(last)[1 - foot][:2] + np.array([0.0, 0.01 * SIDE[foot]])
    np.testing.assert_allclose(last.balance.dcm_reference, end, atol=0.004)
    # The center of mass is at rest when the foot lifts off.
    assert np.abs(last.balance.com_velocity).max() < RULES.rest_speed


def test_the_leaving_foot_is_unloaded_evenly_until_lift_off(one_step):
    run, foot = one_step
    weight, (begun, _) = run.sim.robot.mass * GRAVITY, phases(run)
    duration = run.records[begun].step.desired_step_spec_saturated.action.sway_duration
    for left in (0.75, 0.5, 0.25):
        time = run.records[begun].time - left * RULES.unload_share * duration
        load = loads(run.at(time))[foot] / weight
        assert load < left + 0.05
    assert loads(run.records[begun - 1])[foot] / weight < RULES.still_loaded


@pytest.mark.slow
def test_a_foot_that_cannot_be_unloaded_is_not_lifted():
    run = play(step(), seconds=0.1, controller=rules(still_loaded=0.0))
    duration = run.sim.record.step.t_step_rem
    run.until(lambda record: run.events(STEPS_LEFT))
    assert not any(in_air(record) for record in run.records)
    assert texts(run) == ["step 1 is not taken: its foot cannot be unloaded"]
    action = run.sim.record.step.desired_step_spec_saturated.action
    late = action.sway_duration + RULES.longest_wait
    assert run.sim.time == pytest.approx(0.05 + late, abs=0.03)
    assert run.sim.time < duration


@pytest.mark.slow
def test_a_weight_shift_is_abandoned_when_the_robot_tips_and_the_next_one_waits():
    run = play(step(), seconds=0.3, controller=rules(dcm_lost=0.03) | NO_RECOVERY)
    run.sim.apply_push("trunk", [-2.6 * run.sim.robot.mass, 0.0, 0.0], 0.15)
    run.until(lambda record: run.events(STEPS_LEFT), 1.0)
    given_up = run.sim.time
    run.sim.publish(step(2))
    run.until(lambda record: record.step.current_step_index == 2, 6.0)
    # The weight is back between the feet by then.
    assert run.sim.time - given_up > 0.5
    middle = soles(run.sim.record)[:, :2].mean(axis=0)
    np.testing.assert_allclose(run.sim.record.balance.dcm, middle, atol=0.04)
    run.until(is_done(2))
    assert [step.data["index"] for step in run.events("footstep")] == [2]


@pytest.mark.slow
def test_no_weight_shift_begins_while_the_robot_tips():
    nothing = AtlasSimInterfaceCommand(behavior="STEP")
    run = play(nothing, seconds=0.2, controller=NO_RECOVERY)
    run.sim.apply_push("trunk", [-2.3 * run.sim.robot.mass, 0.0, 0.0], 0.15)
    run.advance(0.15)
    run.sim.publish(step())
    run.advance(0.05)
    assert run.sim.record.step.current_step_index == 0
    # The step is not lost: it begins when the robot has come to rest.
    assert texts(run) == []
    run.until(lambda record: record.step.current_step_index == 1, 4.0)


@pytest.mark.slow
def test_a_heel_that_is_forced_up_rises_in_the_last_part_of_the_shift():
    run = taken(step(x=0.2, toe_off=ToeOff.FORCE_ENABLE))
    begun, _ = phases(run)

    def pitch(record):
        R_WF = rotation_matrix(record.feet.left_orientation)
        return math.asin(-R_WF[2, 0])

    spec = run.records[begun].step.desired_step_spec_saturated
    rises = (
        run.records[begun].time - (1 - RULES.heel_begins) * spec.action.sway_duration
    )
    assert abs(pitch(run.at(rises - 0.05))) < 0.02
    assert pitch(run.records[begun]) > 0.2
    (landing,) = run.events("footstep")
    assert landing.data["error_m"] < 0.01


# ---- the foot in the air -----------------------------------------------------


def test_a_foot_lands_when_it_carries_and_is_then_pressed_flat(one_step):
    run, foot = one_step
    weight, (begun, landed) = run.sim.robot.mass * GRAVITY, phases(run)
    for record in run.records[begun + 2 : landed - 2]:
        assert loads(record)[foot] < RULES.touchdown_force * weight
    assert loads(run.records[landed])[foot] > RULES.touchdown_force * weight
    pressed = run.records[landed + 10 : landed + int(RULES.settle / 0.009)]
    least = min(loads(record)[foot] for record in pressed)
    assert least > 0.8 * RULES.settling_load * weight
    (landing,) = run.events("footstep")
    assert landing.time == pytest.approx(
        run.records[landed].time + RULES.settle, abs=0.03
    )
    side = ("left", "right")[foot]
    assert landing.text.startswith(f"step 1 landed ({side}, ")
    assert landing.data["error_m"] < 0.005


def test_the_center_of_mass_stays_over_the_stance_sole(one_step):
    run, foot = one_step
    begun, landed = phases(run)
    stance = soles(run.records[begun])[1 - foot][:2]
    for record in run.records[begun:landed]:
        assert np.abs(record.balance.com[:2] - stance).max() < 0.04


def test_the_time_left_counts_down_to_the_end_of_the_step(one_step):
    run, _ = one_step
    end = run.events("footstep")[0].time
    stepping = [r for r in run.records if r.step.current_step_index == 1]
    for record in stepping:
        if record.time < end:
            left = record.step.t_step_rem
            assert left == pytest.approx(end - record.time, abs=0.08)


@pytest.mark.slow
@pytest.mark.parametrize("lean", [0.02, -0.02])
def test_the_body_leans_into_the_step_as_far_as_the_foot_can_bring_it_back(lean):
    """The reference moves along the step, within the stance sole."""
    run = taken(step(x=0.2, step_end_dist=lean))
    begun, landed = phases(run)
    start, end = (run.records[k].balance.dcm_reference for k in (begun + 5, landed - 1))
    way = soles(run.records[-1])[LEFT][:2] - soles(run.records[begun])[RIGHT][:2]
    along = (end - start) @ way / np.hypot(*way)
    assert 0.0 < along / lean <= 1.05
    foot = soles(run.records[landed])[RIGHT][:2]
    assert np.abs(end - foot).max() < 0.05


# ---- where a step leads ------------------------------------------------------


@pytest.mark.parametrize(("tilt", "less"), [(0.2, None), (0.45, "0.20")])
def test_a_slope_that_is_too_steep_gives_a_warning(tilt, less):
    run = play(step(normal=(math.sin(tilt), 0.0, math.cos(tilt))), seconds=0.05)
    told = [] if less is None else [f"step 1 is tilted {less} rad less than its normal"]
    assert texts(run, "warning") == told
    assert run.sim.record.step.current_step_index == 1


@pytest.mark.parametrize(("z", "within"), [(0.20, True), (0.205, True), (0.22, False)])
def test_a_rise_at_the_limit_is_taken_despite_rounding_of_the_soles_height(z, within):
    run = play(step(x=0.3, z=z), seconds=0.05)
    assert (run.sim.record.step.current_step_index == 1) == within
    assert ("out of reach" in str(texts(run))) != within


def test_a_foot_is_lifted_no_higher_than_its_leg_folds():
    message = step(x=0.1, lift_height=0.2, swing_height=0.2, knee_nominal=0.9)
    run = play(message, seconds=0.05)
    action = run.sim.record.step.desired_step_spec_saturated.action
    assert 0.1 < action.lift_height <= 0.2
    assert action.lift_height + action.swing_height < 0.35


@pytest.mark.slow
def test_at_rest_the_body_is_half_way_between_feet_at_different_heights():
    # Farther apart, the legs are too short for it.
    block = {"size": [0.3, 0.3, 0.06], "position": [0.26, 0.2, 0.06]}
    level = play(AtlasSimInterfaceCommand(behavior="STEP"), seconds=1.0)
    run = taken(step(x=0.24, z=0.06), terrain=[block])
    run.advance(2.5)
    heights = [r.sim.record.balance.com[2] for r in (level, run)]
    assert heights[1] - heights[0] == pytest.approx(0.03, abs=0.01)
    middle = soles(run.sim.record)[:, :2].mean(axis=0)
    np.testing.assert_allclose(run.sim.record.balance.com[:2], middle, atol=0.02)


# ---- reports and messages ----------------------------------------------------


@pytest.mark.slow
def test_without_a_step_the_robot_waits_in_double_support():
    run = play(AtlasSimInterfaceCommand(behavior="STEP"), seconds=0.5)
    feedback = run.sim.record.step
    assert (feedback.current_step_index, feedback.next_step_index_needed) == (0, 1)
    assert feedback.status_flags == StepStatus.SUBSTATE_SWAYING
    assert feedback.desired_step_saturated.step_index == NO_STEP
    run.ask("STAND")
    run.advance(0.02)
    assert stands(run.sim.record)


@pytest.mark.slow
def test_the_event_at_the_end_names_the_steps_left_out():
    for coming, named in ((None, "step 1"), (step(2), "steps 1, 2")):
        run = play(step(), seconds=0.2)
        run.sim.publish(coming)
        run.advance(0.02)
        run.ask("STAND")
        run.advance(0.02)
        assert stands(run.sim.record)
        assert texts(run) == [f"STEP ends without the {named}"]


@pytest.mark.slow
def test_after_a_step_that_is_done_nothing_is_left_out():
    run = taken(step())
    run.ask("STAND")
    run.until(stands, 0.1)
    assert texts(run) == []


@pytest.mark.slow
def test_the_paths_are_those_of_the_weight_shift_and_then_of_the_foot():
    run = play(step(), seconds=0.1)
    record, paths = run.sim.record, run.sim.output("planned_paths")
    assert record.footsteps == ()
    assert paths.swing is None
    np.testing.assert_allclose(paths.dcm[0], record.balance.dcm_reference, atol=1e-9)
    for path in (paths.com, paths.dcm, paths.cop):
        assert abs(path[-1][1] - soles(record)[RIGHT][1]) < 0.03
    # ξ = c + ċ/ω, along the whole way.
    omega = record.balance.omega
    rate = np.gradient(paths.com, 0.04, axis=0)[1:-1]
    np.testing.assert_allclose((paths.dcm - paths.com)[1:-1], rate / omega, atol=2e-3)
    run.until(in_air)
    start = soles(run.sim.record)[LEFT]
    (target,) = run.sim.record.footsteps
    swing = run.sim.output("planned_paths").swing
    np.testing.assert_allclose(swing[0][:2], start[:2], atol=0.01)
    np.testing.assert_allclose(swing[-1], target.p_WF, atol=0.01)


@pytest.mark.slow
def test_each_message_is_a_new_step_whatever_its_index_but_not_its_repetition():
    run = play(step(foot=RIGHT), seconds=0.05)
    # Many clients send the same message all the time.
    for _ in range(5):
        run.sim.publish(step(foot=RIGHT))
        run.advance(0.02)
    run.until(is_done(1))
    run.advance(0.2)
    assert not in_air(run.sim.record)
    assert len(run.events("footstep")) == 1
    # The same index with another foot is another step.
    run.sim.publish(step(foot=LEFT))
    run.advance(0.05)
    assert run.sim.record.step.t_step_rem > 0.5
    run.sim.publish(step(NO_STEP))
    run.until(is_done(1))
    assert [event.data["foot"] for event in run.events("footstep")] == [RIGHT, LEFT]
