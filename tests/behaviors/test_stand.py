"""STAND on the simulated robot: upright, at rest, also with joints of the user."""

import numpy as np
import pytest

from atlas_drake import AtlasCommand, AtlasSimInterfaceCommand, AtlasState
from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.body_reference import BodyRates, capture_body
from atlas_drake.behaviors.stand.stand import Stand
from atlas_drake.control.gains import ControlGains
from atlas_drake.frozen import replace
from atlas_drake.messages import Behavior

from .conftest import as_request


def test_the_weight_moves_to_the_middle_at_eight_centimetres_a_second(robot, observe):
    middle = 0.5 * sum(foot.p_WF[:2] for foot in observe().terms.feet)
    begin = middle + np.array([0.05, 0.0])
    seen = observe(above=begin)
    body, request = capture_body(seen.terms), as_request(AtlasSimInterfaceCommand())
    stand = Stand(Balance(robot, ControlGains()), 0.9, BodyRates())
    state = stand.enter(seen, body, request)
    np.testing.assert_allclose(state.com, begin)
    after = stand.update(state, seen, body, request, False).state
    np.testing.assert_allclose(after.com - state.com, [-0.08 * seen.dt, 0.0], atol=1e-9)


@pytest.mark.parametrize(
    ("pelvis", "chest", "finished"),
    [(0.0, 0.0, True), (0.0, 0.02, False), (0.02, 0.0, False), (-0.02, 0.0, False)],
)
def test_a_changed_pose_is_finished_with_its_trunk_at_the_target(
    make_tools, observe, pelvis, chest, finished
):
    seen, request = observe(), as_request(AtlasSimInterfaceCommand())
    bent = np.array([0.1, 0.2])

    def pose(upright, observation, request, leaving):
        return replace(upright, pelvis_tilt=bent, chest_tilt=bent)

    stand = make_tools(0.9).stand(pose)
    body = replace(
        capture_body(seen.terms), pelvis_tilt=bent + pelvis, chest_tilt=bent + chest
    )
    state = stand.enter(seen, body, request)
    outcome = stand.update(state, seen, body, request, leaving=True)
    assert outcome.finished == finished
    assert not stand.update(state, seen, body, request, leaving=False).finished


@pytest.mark.parametrize("foot", [0, 1])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_pose_of_a_foot_that_slips_is_latched_again(robot, observe, foot, axis):
    seen = observe()
    body, request = capture_body(seen.terms), as_request(AtlasSimInterfaceCommand())
    stand = Stand(Balance(robot, ControlGains()), 0.9, BodyRates())
    before = stand.enter(seen, body, request)
    for share in (-1.1, -0.9, 0.9, 1.1):
        slip = np.zeros(3)
        slip[axis] = share * 0.01
        feet = list(seen.terms.feet)
        feet[foot] = feet[foot]._replace(p_WF=feet[foot].p_WF + slip)
        now = replace(seen, terms=replace(seen.terms, feet=tuple(feet)))
        after = stand.update(before, now, body, request, False).state
        moved = slip if abs(share) > 1.0 else np.zeros(3)
        for side, old, new in zip((0, 1), before.feet, after.feet, strict=True):
            expected = old.p_WF + moved * (side == foot)
            np.testing.assert_allclose(new.p_WF, expected, atol=1e-12)
        np.testing.assert_allclose(after.middle - before.middle, 0.5 * moved)
        assert after.height - before.height == pytest.approx(0.5 * moved[2])


def test_freeze_stands_still(record):
    recording = record()
    recording.ask(" Freeze ")
    recording.advance(0.7)
    assert recording.looks[-1].report.current_behavior is Behavior.FREEZE
    assert np.abs(recording.sim.atlas_state.velocity).max() < 0.03


@pytest.mark.slow
def test_freeze_holds_staggered_feet_without_sliding(record, walk_message):
    def soles(sim):
        frames = [foot.sole_frame for foot in sim.robot.file.feet]
        return np.array([sim.frame_pose(frame).translation() for frame in frames])

    recording = record()
    recording.sim.publish(walk_message((1, 1, 0.35, -0.12)))
    recording.advance(4.0)
    before = soles(recording.sim)
    recording.ask("freeze")
    recording.advance(2.5)
    assert not recording.sim.has_fallen
    np.testing.assert_allclose(soles(recording.sim), before, atol=1e-3)
    assert np.abs(recording.sim.atlas_state.velocity).max() < 0.02


def test_user_takes_all_joints_at_once(record):
    recording = record()
    command = AtlasSimInterfaceCommand(behavior="user")
    command.k_effort = [0] * 28
    recording.sim.publish(command)
    recording.advance(0.02)
    report = recording.looks[-1].report
    assert report.current_behavior is Behavior.USER
    assert list(report.k_effort) == [255] * 28
    assert not np.any(report.f_out)
    assert np.abs(recording.sim.atlas_state.effort).max() > 1.0


@pytest.fixture(scope="module")
def shared(record):
    """A robot that stands, its left arm the user's, neck and right arm shared."""
    recording = record()
    command = AtlasCommand()
    k_effort = [0] * 28
    k_effort[AtlasState.l_arm_shy : AtlasState.l_arm_wrx + 1] = [255] * 6
    k_effort[AtlasState.r_arm_shy : AtlasState.r_arm_wrx + 1] = [102] * 6
    k_effort[AtlasState.neck_ry] = 204
    command.k_effort = k_effort
    # Well damped, as wrists with the default gains swing for long.
    command.kd_position = [8.0] * 28
    recording.sim.publish(command)
    recording.advance(2.5)
    return recording


@pytest.mark.slow
def test_user_joints_droop_by_gravity_over_stiffness(shared, robot):
    state = shared.sim.atlas_state
    arm = np.flatnonzero(np.array(state.k_effort) == 255)
    assert len(arm) == 6
    plant, context = shared.sim.plant, shared.sim.plant.CreateDefaultContext()
    plant.SetPositionsAndVelocities(context, shared.looks[-1].state)
    gravity = plant.CalcGravityGeneralizedForces(context)[robot.indices(plant).v]
    droop = np.array(state.position) - robot.stand_prep
    np.testing.assert_allclose(
        droop[arm], gravity[arm] / robot.default_kp[arm], atol=1e-3
    )
    # Some do hang visibly, and by their weight.
    assert np.abs(droop[arm]).max() > 0.01
