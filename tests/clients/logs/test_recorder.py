"""A log holds the values of the ports at the ticks, and does not change the run."""

import numpy as np
import pytest

from atlas_drake import AtlasCommand, AtlasSimulation, Scenario, read_log
from atlas_drake.messages.joint_command import JOINT_FIELDS
from atlas_drake.scenario import Jitter

from .conftest import ARM, PERIOD, arm_command, drive, walk_command


def state_of(sim):
    return sim.plant.GetPositionsAndVelocities(
        sim.plant.GetMyContextFromRoot(sim.context)
    )


@pytest.mark.parametrize("period", [0.004, 0.01])
def test_no_tick_is_lost_at_any_period(period, tmp_path):
    """Times are sums of periods, which are rounded."""
    scenario = Scenario(physics_step=0.002, control_period=period)
    with AtlasSimulation(scenario, log=tmp_path / "run.mcap") as sim:
        sim.advance_to(0.1001)
    log = read_log(tmp_path / "run.mcap")
    np.testing.assert_allclose(log.time, np.arange(0.0, 0.1001, period), atol=1e-9)
    assert log.header.control_period == pytest.approx(period)


def test_recording_does_not_change_the_motion(run, scenario):
    recorded, _ = run
    plain = AtlasSimulation(scenario)
    drive(plain)
    np.testing.assert_array_equal(state_of(recorded), state_of(plain))
    assert recorded.events == plain.events
    assert recorded.record == plain.record


def test_a_row_has_the_values_of_the_ports(tmp_path, scenario):
    sim = AtlasSimulation(scenario, log=tmp_path / "run.mcap")
    messages = [AtlasCommand(kp_position=[7.0] * 28), arm_command()]
    for message in messages:
        sim.publish(message)
    seen = []
    for tick in range(12):
        sim.advance_to(PERIOD * tick)
        names = ("state", "behavior_state", "foot_wrenches")
        before = {name: np.array(sim.output(name)) for name in names}
        before["report"] = sim.atlas_sim_interface_state
        # What motors do and touch changes in the tick.
        before["atlas_state"] = sim.atlas_state
        # The control tick, after which the physics is a step further.
        sim.simulator.AdvancePendingEvents()
        names = ("controller_status", "behavior_effort", "commands")
        seen.append((before, *map(sim.output, names)))
    sim.advance_to(PERIOD * 12)
    sim.close()
    log = read_log(tmp_path / "run.mcap")
    assert len(log) == 12
    assert [command.message for command in log.commands] == messages
    num_q = sim.plant.num_positions()
    indices = sim.robot.indices(sim.plant)
    for row, (before, status, effort, commands) in enumerate(seen):
        report, measured = before["report"], before["behavior_state"]
        state, (left, right) = before["atlas_state"], report.foot_pos_est
        expected = {
            "time": state.header.stamp,
            "state.q": before["state"][:num_q],
            "state.v": before["state"][num_q:],
            "joints.position": measured[indices.q],
            "joints.velocity": measured[num_q + indices.v],
            "joints.behavior_effort": effort,
            "behavior.current": status.current_behavior,
            "behavior.request_number": commands.request.number,
            "controller.unsolved": status.unsolved,
            "controller.solved": status.solved,
            "balance.omega": status.plan.omega,
            "pelvis.position": report.pos_est.position.to_array(),
            "pelvis.velocity": report.pos_est.velocity.to_array(),
            "feet.left_position": left.position.to_array(),
            "feet.right_orientation": right.orientation.to_wxyz(),
            "feet.left_torque": before["foot_wrenches"][:3],
            "feet.right_force": before["foot_wrenches"][9:],
            "imu.orientation": state.orientation.to_wxyz(),
            "imu.angular_velocity": state.angular_velocity.to_array(),
        }
        for name in ("com", "dcm", "cop"):
            reference = f"{name}_reference"
            expected[f"balance.{reference}"] = getattr(status.plan, reference)
        for name in JOINT_FIELDS:
            column = f"gains.{name}"
            if column not in log.arrays:
                of_user = "" if name == "k_effort" else "_setpoint"
                column = f"joints.{name}{of_user}"
            expected[column] = getattr(commands.joints, name)
        for name, value in expected.items():
            np.testing.assert_array_equal(log[name][row], value, err_msg=name)
    # The behavior has all joints but one, whose effort is the user's. The motors of
    # legs and back add what holds their speeds.
    others = ~sim.robot.limb("l_leg", "r_leg", "back")
    others[ARM] = False
    applied = log["joints.effort"]
    np.testing.assert_allclose(
        applied[:, others], log["joints.behavior_effort"][:, others]
    )
    np.testing.assert_allclose(applied[:, ARM], log["joints.user_effort"][:, ARM])
    assert (applied[:, ARM] != 0.0).any()


def test_balance_is_consistent(log):
    """Standing still: CoM, DCM and CoP over the feet, and where they should be."""
    standing = slice(10, 40)
    support = 0.1
    for name in ("com", "dcm", "cop", "dcm_reference", "cop_reference"):
        assert np.abs(log[f"balance.{name}"][standing]).max(axis=0)[1] < support, name
    error = (log["balance.dcm"] - log["balance.dcm_reference"])[standing]
    assert np.abs(error).max() < 0.05
    weight = log["feet.left_force.z"][-20:] + log["feet.right_force.z"][-20:]
    assert weight.mean() == pytest.approx(9.81 * log.robot.mass, rel=0.2)
    assert log["imu.linear_acceleration.z"][20:].mean() == pytest.approx(9.81, abs=2)
    assert (log["controller.tick_time"] > 0.0).all()


def test_commands_and_events_are_kept_with_their_times(run):
    sim, log = run
    arm, walk = log.commands
    assert (arm.time, walk.time) == pytest.approx((0.05, 0.14))
    assert (arm.message, walk.message) == (arm_command(), walk_command())
    assert log.record(0).request is None
    assert log.record(len(log) - 1).request == walk_command()
    happened = sorted(sim.events, key=lambda event: event.time)
    assert [(event.kind, event.text, event.data) for event in log.events] == [
        (event.kind, event.text, event.data) for event in happened
    ]
    times = [event.time for event in happened]
    assert [event.time for event in log.events] == pytest.approx(times)
    assert {"push", "behavior"} <= {event.kind for event in log.events}
    refused = [event for event in log.events if event.kind == "refusal"]
    assert [event.data["field"] for event in refused] == ["k_effort[1]", "k_effort[0]"]
    assert log["behavior.error_code"].min() < 0  # Of the refusals.


def test_a_log_continues_after_a_reset_and_ends_when_closed(tmp_path):
    file = tmp_path / "run.mcap"
    with AtlasSimulation(log=file) as sim:
        sim.advance_to(3 * PERIOD)
        sim.publish(AtlasCommand())
        sim.apply_push("utorso", [5.0, 0.0, 0.0], PERIOD)
        sim.advance_to(5 * PERIOD)
        sim.reset()
        sim.advance_to(10 * PERIOD)
        sim.close()
        sim.advance_to(15 * PERIOD)
    log = read_log(file)
    np.testing.assert_allclose(log.time, PERIOD * np.arange(10), atol=1e-9)
    # No event is told twice.
    assert [event.kind for event in log.events] == ["push", "reset"]
    assert len(log.commands) == 1


def test_a_forgotten_log_is_completed_with_its_simulation(tmp_path):
    sim = AtlasSimulation(log=tmp_path / "run.mcap")
    sim.advance_to(5 * PERIOD)
    del sim
    assert len(read_log(tmp_path / "run.mcap")) == 5


@pytest.mark.slow
def test_hands_of_a_fallen_robot_bear_load(tmp_path):
    scenario = Scenario(initial_behavior="USER", jitter=Jitter(joints=0.6))
    file = tmp_path / "run.mcap"
    with AtlasSimulation(scenario, log=file) as sim:
        sim.advance_to(416 * PERIOD)
        state = sim.atlas_state  # At the instant of the last row.
        sim.advance_to(417 * PERIOD)
    log = read_log(file)
    (fall,) = [event for event in log.events if event.kind == "fall"]
    # The arms touch the trunk in the random pose of the start.
    upright = (log.time > 0.1) & (log.time < fall.time)
    for side, wrench in (("left", state.l_hand), ("right", state.r_hand)):
        force, torque = (log[f"hands.{side}_{part}"] for part in ("force", "torque"))
        assert not force[upright].any()
        np.testing.assert_allclose(force[-1], wrench.force.to_array(), atol=1e-6)
        np.testing.assert_allclose(torque[-1], wrench.torque.to_array(), atol=1e-6)
    hands = np.abs(log["hands.left_force"]), np.abs(log["hands.right_force"])
    assert np.max(hands) > 20.0


@pytest.mark.slow
def test_the_footsteps_of_a_walk_are_read_as_they_were_planned(tmp_path):
    # While a foot swings, all that can be asked of a footstep has been asked.
    path = tmp_path / "run.mcap"
    with AtlasSimulation(log=path) as sim:
        sim.publish(walk_command())
        sim.advance(1.2)
        sim.advance(0.5 * PERIOD)
        planned = sim.record.footsteps
    log = read_log(path)
    footsteps = log.record(len(log) - 1).footsteps
    assert planned
    assert [(step.index, step.foot, step.yaw) for step in footsteps] == [
        (step.index, step.foot, step.yaw) for step in planned
    ]
    np.testing.assert_array_equal(footsteps[0].p_WF, planned[0].p_WF)
