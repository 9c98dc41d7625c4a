"""The whole tutorial, and the schedule that it consists of."""

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, AtlasState, Behavior, Scenario
from atlas_drake.robot import load_robot
from atlas_drake.simulation.tutorial import (
    DURATION,
    FIRST_COMMAND,
    STEPS,
    USER_TARGETS,
    tutorial_schedule,
)

BEFORE_WALK = FIRST_COMMAND + 7.0 - 0.01
"""The user's joints have had two seconds [s]."""
AFTER_WALK = FIRST_COMMAND + 13.0 - 0.01
"""The walk is over, the last command not sent [s]."""
LANDING_ERROR = 0.02
"""[m]"""
SETTLED = 0.05
"""Farthest that a settled joint may be from where its gains let it [rad]."""

LINES = [
    "[USER] Going to stand prep position...",
    "[USER] Warming up BDI stand...",
    "[BDI] Standing...",
    "[USER/BDI] Command neck and arms...",
    "[USER/BDI] Walking...",
    "[USER] Going to home position...",
]


def user_joint_errors(sim):
    """How far the user's joints are from set-point less gravity droop [rad]."""
    plant, state = sim.plant, sim.atlas_state
    context = plant.CreateDefaultContext()
    state_now = sim.diagram.GetOutputPort("state").Eval(sim.context)
    plant.SetPositionsAndVelocities(context, state_now)
    gravity = plant.CalcGravityGeneralizedForces(context)[sim.robot.indices(plant).v]
    errors = {}
    for name, target in USER_TARGETS.items():
        joint = getattr(AtlasState, name)
        assert state.k_effort[joint] == 255
        droop = gravity[joint] / state.kp_position[joint]
        errors[name] = abs(state.position[joint] - (target + droop))
    return errors


def assert_settled(sim):
    errors = user_joint_errors(sim)
    assert max(errors.values()) <= SETTLED, errors


@pytest.mark.slow
def test_the_whole_tutorial_at_a_longer_physics_step():
    sim = AtlasSimulation(Scenario(schedule="tutorial", physics_step=0.0045))
    sim.advance_to(BEFORE_WALK)
    assert sim.current_behavior is Behavior.STAND
    assert_settled(sim)
    start = sim.pelvis_pose.translation()
    sim.advance_to(AFTER_WALK)
    assert sim.current_behavior is Behavior.STAND
    assert_settled(sim)
    # Both feet half a metre ahead of where the pelvis was, the origin of the steps.
    feet = [pose.position for pose in sim.atlas_sim_interface_state.foot_pos_est]
    for foot, side in zip(feet, (0.15, -0.15), strict=True):
        expected = [start[0] + 0.5, start[1] + side, 0.0]
        np.testing.assert_allclose(foot.to_array(), expected, atol=0.025)
    assert sim.pelvis_pose.translation()[2] == pytest.approx(start[2], abs=0.03)
    sim.advance_to(DURATION)
    taken = [(step["index"], step["foot"]) for step in sim.footsteps]
    assert taken == [(1, 0), (2, 1), (3, 0), (4, 1)]
    assert max(step["error_m"] for step in sim.footsteps) <= LANDING_ERROR
    summary = sim.summary()
    assert not summary["fell"]
    assert summary["success"]
    assert summary["max_pelvis_tilt_rad"] < 0.3
    # No step down, no joint driven beyond its motor.
    assert summary["min_pelvis_height"] > 0.7
    assert max(summary["peak_effort_fraction"].values()) <= 1.0
    commands = [event for event in sim.events if event.kind == "command"]
    assert [event.text for event in commands] == LINES
    assert [event.time for event in commands] == [2.0, 4.0, 5.0, 7.0, 9.0, 15.0]
    assert [event.text for event in sim.events if event.kind == "behavior"] == [
        "STAND -> STAND_PREP",
        "STAND_PREP -> STAND",
        "STAND -> WALK",
        "WALK -> STAND (by itself)",
    ]
    # In the end all joints are the user's, on their way to zero. The robot hops, lands
    # on the edges of its feet, and comes to rest: a joint whose damping counts on a
    # floor that the foot rolls over spins.
    assert list(sim.atlas_state.k_effort) == [255] * 28
    sim.advance(1.0)
    fastest = 0.0
    for _ in range(100):
        sim.advance(0.02)
        fastest = max(fastest, np.abs(sim.atlas_state.velocity).max())
    assert fastest < 0.5


def test_literally_the_arm_command_brings_no_velocity_gains():
    robot = load_robot()
    arms = [
        tutorial_schedule(robot, literal=literal)[3].command
        for literal in (False, True)
    ]
    assert list(arms[0].kp_velocity) == [50.0] * 28
    assert list(arms[1].kp_velocity) == []
    assert list(arms[0].kp_position) == list(arms[1].kp_position)


def test_the_steps_that_people_read_are_those_of_the_schedule():
    times = {entry.time for entry in tutorial_schedule(load_robot("atlas"))}
    assert len(STEPS) == 5
    assert times >= {step.begin for step in STEPS}


@pytest.mark.slow
def test_a_schedule_is_dropped_at_once():
    sim = AtlasSimulation(Scenario(schedule="tutorial"))
    sim.advance(0.1)
    sim.drop_schedule()
    sim.drop_schedule()  # Nothing is left.
    sim.advance(FIRST_COMMAND)
    assert not [event for event in sim.events if event.kind == "command"]
    dropped = [event.text for event in sim.events if event.kind == "schedule"]
    assert dropped == ["the rest of the schedule is dropped, 6 commands"]
