"""Every control of the cockpit does what it says, on a simulated robot."""

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, Behavior, InvalidMessageError, Scenario
from atlas_drake.cockpit.clock_controls import KEPT_EVERY, SINGLE_STEP
from atlas_drake.cockpit.joint_controls import DAMPING, SPEED
from atlas_drake.cockpit.mode_controls import refusal_in_words
from atlas_drake.cockpit.operator import CONTROLS
from atlas_drake.cockpit.page.keys import KEYS
from atlas_drake.errors import AtlasError

from .conftest import Driven

ACTS_WITHIN = 0.1
"""Simulated time from a click until the controller has heard it [s]."""


def joints_of(driven):
    return driven.sim.output("commands").joints


def test_every_control_that_the_page_may_use_exists(driven):
    for group, names in CONTROLS.items():
        for name in names:
            assert callable(getattr(getattr(driven.operator, group), name))
    for key in KEYS.values():
        group, name = key.control.split(".")
        assert name in CONTROLS[group]


@pytest.mark.parametrize(
    "control", ["clock._begin", "_seen.x", "walk.update", "update", "", "walk.__init__"]
)
def test_nothing_else_can_be_called(driven, control):
    with pytest.raises(InvalidMessageError, match="there is no control"):
        driven.do(control)


@pytest.mark.parametrize(
    ("control", "values"),
    [
        ("walk.steer", {"forward": float("nan")}),
        ("walk.steer", {"forward": 1e6}),
        ("walk.steer", {"sideways": 1.0}),
        ("walk.set_gait", {"stride": -5.0}),
        ("walk.set_gait", {"limits": 1.0}),
        ("walk.plan_to", {"x": "far", "y": 0.0}),
        ("walk.plan_to", {"x": 1e9, "y": 0.0}),
        ("walk.move_step", {"index": 1, "x": 0.0, "y": 0.0}),
        ("walk.send_plan", {}),
        ("joints.share", {"joints": ["l_arm_shx"], "k_effort": 256}),
        ("joints.share", {"joints": ["nose"], "k_effort": 1}),
        ("joints.share", {"joints": "l_arm_shx", "k_effort": 1}),
        ("joints.move", {"joint": "l_arm_shx", "position": 40.0}),
        ("joints.gains", {"joint": "l_arm_shx", "kp_position": -1.0}),
        ("joints.gains", {"joint": "l_arm_shx", "mass": 1.0}),
        ("joints.go_to_pose", {"name": "handstand"}),
        ("joints.save_pose", {"name": " "}),
        ("pelvis.move", {"pelvis_height": 0.8}),
        ("pushes.push", {"body": "utorso", "impulse_W": [1.0, 2.0]}),
        ("pushes.push", {"body": "utorso", "impulse_W": [1e6, 0.0, 0.0]}),
        ("pushes.push", {"body": "nose", "impulse_W": [1.0, 0.0, 0.0]}),
        ("clock.pace", {"rate": -5.0}),
        ("clock.back", {"seconds": 10.0}),
        ("modes.request", {"name": "FLY"}),
        ("modes.request", {"name": "STAND", "params": {"a": 1}}),
        ("view.show", {"overlay": "x-ray", "on": True}),
        ("view.show", {"overlay": ["com"], "on": True}),
        ("view.show", {"overlay": "com", "on": "yes"}),
    ],
)
def test_what_cannot_be_used_is_refused_and_changes_nothing(driven, control, values):
    before = driven.sim.output("commands").received
    with pytest.raises((AtlasError, ValueError)):
        driven.do(control, **values)
    assert driven.sim.output("commands").received == before
    driven.go(0.04)
    assert driven.sim.current_behavior is Behavior.STAND


def test_steering_walks_within_a_tenth_of_a_second(driven):
    driven.do("walk.steer", forward=1.0)
    driven.go(ACTS_WITHIN)
    assert driven.sim.current_behavior is Behavior.WALK


def test_a_plan_keeps_the_height_of_the_ground():
    sim = AtlasSimulation(Scenario(world="qual_task_1"))
    driven = Driven(sim)
    driven.do("walk.plan_to", x=0.5, y=0.0)
    place = driven.operator.walk.plan[0].pose.position
    driven.do("walk.move_step", index=1, x=place.x, y=place.y)
    heights = [step.pose.position.z for step in driven.operator.walk.plan]
    assert heights == pytest.approx([1.0] * len(heights), abs=0.01)
    driven.do("walk.send_plan")
    driven.go(0.2)
    assert sim.current_behavior is Behavior.WALK
    assert not [event for event in sim.events if event.kind == "steps left"]


def test_a_dropped_plan_is_not_sent(driven):
    driven.do("walk.plan_to", x=1.0, y=0.0, yaw=0.0)
    driven.do("walk.drop_plan")
    with pytest.raises(InvalidMessageError):
        driven.do("walk.send_plan")


def test_the_nearest_gait_that_can_be_walked_holds(driven):
    in_force = driven.do("walk.set_gait", stride=30.0)
    assert in_force["stride"] == driven.operator.walk.gait.stride < 1.0


def test_a_joint_that_is_taken_stays_and_then_follows_at_a_bounded_speed(driven):
    sim = driven.sim
    elbow = sim.robot.joint_index("l_arm_ely")
    before = sim.atlas_state.position[elbow]
    driven.do("joints.share", joints=["l_arm_ely"], k_effort=255)
    driven.go(0.2)
    joints = joints_of(driven)
    assert joints.k_effort[elbow] == 255
    assert joints.k_effort.sum() == 255
    assert joints.kp_velocity[elbow] == DAMPING
    assert joints.position[elbow] == pytest.approx(before)
    driven.do("joints.move", joint="l_arm_ely", position=before - 0.1)
    driven.go(0.06)
    assert abs(joints_of(driven).position[elbow] - before) <= 0.08 * SPEED + 1e-9
    driven.go(0.1)
    assert joints_of(driven).position[elbow] == pytest.approx(before - 0.1)


def test_joints_hold_go_limp_and_go_to_poses(driven):
    names = [name for name in driven.sim.robot.joint_names if name.startswith("l_arm")]
    chosen = driven.sim.robot.limb("l_arm")
    driven.do("joints.share", joints=names, k_effort=255)
    driven.do("joints.gains", joint="l_arm_shx", kp_position=11.0)
    driven.go(0.02)
    index = driven.sim.robot.joint_index("l_arm_shx")
    assert joints_of(driven).kp_position[index] == 11.0
    driven.do("joints.go_limp")
    driven.go(0.02)
    assert not joints_of(driven).kp_position[chosen].any()
    assert joints_of(driven).kp_position[~chosen].any()
    driven.do("joints.hold")
    driven.go(0.02)
    assert joints_of(driven).kp_position[chosen].all()
    driven.do("joints.save_pose", name="here")
    assert "here" in driven.operator.joints.poses
    driven.do("joints.go_to_pose", name="here")
    driven.go(0.02)


def test_user_takes_all_joints_and_the_next_behavior_gives_back(driven):
    driven.do("joints.share", joints=["l_arm_ely"], k_effort=100)
    driven.go(0.02)
    driven.do("modes.request", name="USER")
    driven.go(0.04)
    assert set(joints_of(driven).k_effort) == {255}
    driven.do("modes.request", name="FREEZE")
    driven.go(0.04)
    assert joints_of(driven).k_effort.sum() == 100


def test_a_behavior_that_would_be_refused_says_why(driven):
    refusals = driven.operator.modes.refusals()
    assert not refusals["WALK"]
    assert not refusals["MANIPULATE"]
    driven.do("modes.request", name="FREEZE")
    driven.go(0.04)
    why = driven.operator.modes.refusals()["MANIPULATE"]
    assert why == "MANIPULATE may follow STAND, not FREEZE"


def test_a_fallen_robot_needs_a_reset(driven):
    entry = driven.sim.behaviors.entry(Behavior.STAND)
    catalog = driven.sim.behaviors
    assert "reset" in refusal_in_words(entry, entry, catalog, fallen=True)
    assert not refusal_in_words(entry, entry, catalog, fallen=False)


def test_the_pelvis_moves_and_keeps_what_is_not_asked(driven):
    driven.do("modes.request", name="MANIPULATE")
    driven.go(0.1)
    before = driven.sim.atlas_sim_interface_state.manipulate_feedback.clamped
    driven.do("pelvis.move", pelvis_height=before.pelvis_height - 0.05)
    driven.go(0.05)
    driven.do("pelvis.move", pelvis_yaw=0.1)
    driven.go(0.05)
    clamped = driven.sim.atlas_sim_interface_state.manipulate_feedback.clamped
    assert clamped.pelvis_height == pytest.approx(before.pelvis_height - 0.05)
    assert clamped.pelvis_yaw == pytest.approx(0.1)


def test_a_push_tells_what_it_changes(driven):
    change = driven.do("pushes.push", body="utorso", impulse_W=[9.0, 0.0, 0.0])
    assert change == pytest.approx(9.0 / driven.sim.robot.mass)
    assert driven.sim.output("pushes").begun == 1


def test_time_is_paused_stepped_and_paced(driven):
    clock = driven.operator.clock
    driven.do("clock.single_step")
    assert clock.paused
    assert clock.takes_step()
    assert not clock.takes_step()
    driven.do("clock.go_on")
    assert not clock.paused
    driven.do("clock.pace", rate=2.0)
    assert driven.sim.realtime_rate == 2.0
    driven.do("clock.pace", rate=0.0)
    assert 0.0 < SINGLE_STEP <= 0.02


def test_time_goes_back_to_what_was(driven):
    clock, sim = driven.operator.clock, driven.sim
    clock.keep_snapshot()
    driven.go(KEPT_EVERY)
    clock.keep_snapshot()
    state = sim.output("state").copy()
    driven.do("modes.request", name="FREEZE")
    driven.go(0.2)
    assert driven.do("clock.back", seconds=0.1) == pytest.approx(KEPT_EVERY)
    assert np.array_equal(sim.output("state"), state)
    assert sim.current_behavior is Behavior.STAND
    assert driven.do("clock.back", seconds=10.0) == 0.0


def test_a_reset_forgets_what_went_on(driven):
    driven.do("walk.steer", forward=1.0)
    driven.do("walk.plan_to", x=1.0, y=0.0)
    driven.do("clock.reset")
    assert driven.operator.walk.direction is None
    assert driven.operator.walk.plan == ()
    driven.go(ACTS_WITHIN)
    assert driven.sim.current_behavior is Behavior.STAND


def test_stop_comes_to_rest(driven):
    driven.do("modes.request", name="MANIPULATE")
    driven.go(0.1)
    driven.do("modes.stop")
    driven.go(0.1)
    assert driven.sim.atlas_sim_interface_state.desired_behavior == Behavior.STAND
