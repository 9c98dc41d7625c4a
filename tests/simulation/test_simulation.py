"""``AtlasSimulation``: arguments, refusals, and results."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from pydrake.common.eigen_geometry import Quaternion as DrakeQuaternion
from pydrake.math import RotationMatrix

from atlas_drake import (
    AtlasCommand,
    AtlasError,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    AtlasState,
    Behavior,
    BehaviorStatus,
    InvalidMessageError,
    Scenario,
    ScenarioError,
    Start,
    WaitTimeoutError,
    read_log,
)
from atlas_drake.errors import ErrorCode

TICK = Scenario().resolved().control_period
"""Control period of the default scenario [s]."""


@pytest.fixture(scope="module")
def shared():
    return AtlasSimulation()


@pytest.fixture
def sim(shared):
    """A new run, which equals that of a new simulation and begins much faster."""
    shared.listeners.clear()
    shared.reset(seed=0)
    return shared


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("scenario", "x.yaml"),
        ("overlays", ["com"]),
        ("view", 1),
        ("listeners", print),
        ("log", True),
        ("log", b"run.mcap"),
    ],
)
def test_an_argument_of_the_wrong_type_is_named(name, value):
    with pytest.raises(TypeError, match=f"{name} must be") as caught:
        AtlasSimulation(**{name: value})
    assert repr(value) in str(caught.value)


def behavior_command(behavior, **fields):
    return AtlasSimInterfaceCommand(behavior=behavior, **fields)


# ---- commands ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("message", "field", "code"),
    [
        (
            AtlasCommand(position=[0.0] * 27, k_effort=[255] * 28),
            "position",
            ErrorCode.VALUE_OUT_OF_RANGE,
        ),
        (
            AtlasCommand(effort=[0.0] * 27 + [np.nan], k_effort=[255] * 28),
            "effort[27]",
            ErrorCode.VALUE_OUT_OF_RANGE,
        ),
        (
            behavior_command("SIT", k_effort=[255] * 28),
            "behavior",
            ErrorCode.NO_SUCH_BEHAVIOR,
        ),
        (
            behavior_command("USER", k_effort=[300] * 28),
            "k_effort[0]",
            ErrorCode.VALUE_OUT_OF_RANGE,
        ),
    ],
    ids=["length", "nan", "behavior", "k_effort"],
)
def test_a_bad_message_raises_is_reported_and_changes_nothing(
    sim, message, field, code
):
    with pytest.raises(InvalidMessageError) as caught:
        sim.publish(message)
    assert caught.value.field == field
    assert caught.value.error_code is code
    sim.advance(3 * TICK)
    report = sim.atlas_sim_interface_state
    assert report.error_code is code
    assert report.current_behavior is Behavior.STAND
    assert list(report.k_effort) == [0] * 28
    assert list(sim.atlas_state.position) != []
    (event,) = sim.events
    assert event.kind == "refusal"
    assert field in event.text
    assert not sim.summary()["success"]
    # A good one clears the code.
    sim.publish(behavior_command("STAND"))
    sim.advance(TICK)
    assert sim.atlas_sim_interface_state.error_code is ErrorCode.NO_ERRORS


def test_messages_of_one_instant_are_taken_in_their_order(sim):
    neck = AtlasState.neck_ry
    # The gains of one and the shares of the next, and what comes last counts.
    sim.publish(AtlasCommand(kp_position=[7.0] * 28))
    sim.publish(AtlasCommand(k_effort=[255] * 28))
    stand = behavior_command("STAND")
    stand.k_effort = [0] * 28
    sim.publish(stand)
    sim.publish(AtlasCommand(k_effort=[255 * (k == neck) for k in range(28)]))
    sim.advance(TICK)
    state = sim.atlas_state
    assert list(state.kp_position) == [7.0] * 28
    assert [k for k in range(28) if state.k_effort[k]] == [neck]


def test_the_error_is_that_of_the_last_message(sim):
    def report():
        sim.advance(TICK)
        return sim.atlas_sim_interface_state

    sim.publish(behavior_command("USER"))
    sim.publish(behavior_command("WALK"))
    assert report().error_code is ErrorCode.FAILED_TO_START_BEHAVIOR
    sim.publish(AtlasCommand())
    assert report().error_code is ErrorCode.NO_ERRORS
    with pytest.raises(InvalidMessageError):
        sim.publish(behavior_command("HOP"))
    unknown = BehaviorStatus.FAILED_TRANS_UNKNOWN_BEHAVIOR
    assert report().error_code is ErrorCode.NO_SUCH_BEHAVIOR
    assert report().behavior_feedback.status_flags & unknown
    sim.publish(behavior_command("USER"))
    assert not report().behavior_feedback.status_flags & unknown


def test_a_published_message_is_a_copy(sim):
    command = AtlasCommand(k_effort=[0] * 28, position=[0.1] * 28)
    command.k_effort[AtlasState.neck_ry] = 255
    sim.publish(command)
    command.k_effort[AtlasState.neck_ry] = 7
    command.position = [9.0] * 28
    sim.advance(5 * TICK)
    expected = [0] * 28
    expected[AtlasState.neck_ry] = 255
    assert list(sim.atlas_state.k_effort) == expected
    # The same message changed and sent again is new.
    sim.publish(command)
    sim.advance(5 * TICK)
    assert sim.atlas_state.k_effort[AtlasState.neck_ry] == 7


def test_gains_in_force_are_reported(sim):
    state = sim.atlas_state
    np.testing.assert_array_equal(state.kp_position, sim.robot.default_kp)
    np.testing.assert_array_equal(state.kd_position, sim.robot.default_kd)
    sim.publish(AtlasCommand(ki_position=[1.0] * 28, i_effort_max=[2.0] * 28))
    sim.advance(2 * TICK)
    state = sim.atlas_state
    assert list(state.ki_position) == [1.0] * 28
    assert list(state.i_effort_max) == [2.0] * 28
    np.testing.assert_array_equal(state.kp_position, sim.robot.default_kp)


# ---- time ----------------------------------------------------------------------


def test_time_is_the_sum_of_the_advances(sim):
    assert sim.time == 0.0
    sim.advance(0.03)
    assert sim.time == pytest.approx(0.03)
    sim.advance_to(0.05)
    assert sim.time == pytest.approx(0.05)
    sim.advance_to(sim.time)
    sim.advance(0.0)
    assert sim.time == pytest.approx(0.05)
    for message in (sim.atlas_state, sim.atlas_sim_interface_state, sim.imu):
        assert message.header.stamp == sim.time


@pytest.mark.parametrize("t", [0.01, -1.0, np.nan, np.inf, 10**400, "soon", None])
def test_times_that_are_past_or_not_finite_are_refused(sim, t):
    sim.advance(0.02)
    with pytest.raises(ValueError, match="cannot advance"):
        sim.advance_to(t)
    assert sim.time == pytest.approx(0.02)


# ---- sensors -------------------------------------------------------------------


def test_every_output_port_can_be_read_by_its_name(sim):
    ports = range(sim.diagram.num_output_ports())
    names = [sim.diagram.get_output_port(i).get_name() for i in ports]
    assert {"effort", "state", "atlas_state", "imu"} <= set(names)
    for name in names:
        assert sim.output(name) is not None
    with pytest.raises(ValueError, match="'efort'"):
        sim.output("efort")
    sim.advance(TICK)
    assert sim.output("atlas_state").header.stamp == sim.atlas_state.header.stamp > 0.0
    assert sim.output("effort").shape == (sim.robot.num_joints,)


def test_the_gyroscopes_noise_is_in_its_own_axes():
    scenario = Scenario(noise="rough", seed=3, start=Start(yaw=1.2))
    sim = AtlasSimulation(scenario)
    sim.advance(0.05)
    measured = sim.diagram.GetOutputPort("behavior_state").Eval(sim.context)
    imu = sim.imu
    q = imu.orientation
    R_WI = RotationMatrix(DrakeQuaternion([q.w, q.x, q.y, q.z])).matrix()
    w_WP = measured[sim.plant.num_positions() :][:3]
    in_imu = imu.angular_velocity.to_array()
    np.testing.assert_allclose(R_WI.T @ w_WP, in_imu, atol=1e-9)


@pytest.mark.parametrize("value", [-1, np.nan, np.inf, 10**400, "fast", None])
def test_arguments_that_make_no_sense_are_named(sim, value):
    with pytest.raises(InvalidMessageError, match="rate"):
        sim.set_realtime_rate(value)
    with pytest.raises(InvalidMessageError, match="seconds"):
        sim.advance(value)
    with pytest.raises(InvalidMessageError, match="timeout"):
        sim.wait_until(lambda _: True, value)
    with pytest.raises(InvalidMessageError, match="period"):
        sim.wait_until(lambda _: False, 1.0, period=value)


# ---- waiting -------------------------------------------------------------------


def test_waiting_ends_when_the_condition_holds(sim):
    assert sim.wait_until(lambda sim: True, 0.0) == 0.0
    waited = sim.wait_until(lambda sim: sim.time > 0.03, period=0.01)
    assert waited == sim.time == pytest.approx(0.04)


def test_waiting_in_vain_ends_with_an_error_that_says_when(sim):
    sim.advance(0.01)
    with pytest.raises(
        WaitTimeoutError,
        match=r"the walk did not hold within 0.03 s.* 0.010 s to 0.040",
    ) as caught:
        sim.wait_until(lambda sim: False, 0.03, what="the walk")
    assert sim.time == pytest.approx(0.04)
    assert isinstance(caught.value, TimeoutError)
    assert isinstance(caught.value, AtlasError)


# ---- pushes --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        (("tail", [1.0, 0.0, 0.0], 0.1), "body"),
        (("utorso", [1.0, 0.0], 0.1), "force_W"),
        (("utorso", [1.0, 0.0, np.inf], 0.1), "force_W"),
        (("utorso", [1.0, 0.0, 0.0], 0.0), "duration"),
    ],
)
def test_invalid_pushes_are_refused(sim, arguments, field):
    with pytest.raises(InvalidMessageError) as caught:
        sim.apply_push(*arguments)
    assert caught.value.field == field
    assert repr(caught.value.value) in str(caught.value)
    assert sim.events == []


# ---- what it tells -------------------------------------------------------------


def test_at_rest_the_sensors_measure_gravity_and_weight(sim):
    sim.advance(0.6)
    imu, state = sim.imu, sim.atlas_state
    np.testing.assert_allclose(
        imu.linear_acceleration.to_array(), [0.0, 0.0, 9.81], atol=0.3
    )
    np.testing.assert_allclose(imu.angular_velocity.to_array(), np.zeros(3), atol=0.1)
    load = state.l_foot.force.z + state.r_foot.force.z
    assert load == pytest.approx(sim.robot.mass * 9.81, rel=0.05)
    assert state.l_foot.force.z == pytest.approx(state.r_foot.force.z, rel=0.1)
    for hand in (state.l_hand, state.r_hand):
        np.testing.assert_array_equal(hand.force.to_array(), np.zeros(3))
    feet = [pose.position for pose in sim.atlas_sim_interface_state.foot_pos_est]
    assert feet[0].y > 0.1 > -0.1 > feet[1].y


def test_the_summary_is_json_and_says_what_was_run(summary_keys):
    scenario = Scenario(seed=5, physics_step=0.002, model="atlas_v3")
    sim = AtlasSimulation(scenario)
    assert sim.summary()["controller_tick_ms"]["median"] is None
    sim.advance(0.1)
    summary = json.loads(json.dumps(sim.summary(), allow_nan=False))
    assert summary.keys() >= summary_keys
    assert summary["model"] == "atlas_v3"
    assert summary["seed"] == 5
    assert summary["physics_step"] == 0.002
    assert summary["sim_time"] == pytest.approx(0.1)
    assert summary["success"]
    assert not summary["fell"]
    assert summary["footsteps"] == []
    assert summary["peak_effort_fraction"].keys() == set(sim.robot.joint_names)
    assert all(0.0 <= f <= 1.0 for f in summary["peak_effort_fraction"].values())
    ticks = summary["controller_tick_ms"]
    assert 0.0 < ticks["median"] <= ticks["p99"] <= ticks["max"]
    height = summary["final_pelvis_pose"]["position"][2]
    assert summary["min_pelvis_height"] == pytest.approx(height, abs=0.02)


def test_events_are_told_at_once_and_in_order(sim):
    told = []
    sim.listeners.append(SimpleNamespace(event=told.append))
    sim.advance(0.04)
    sim.publish(behavior_command("FREEZE"))
    sim.advance(0.04)
    sim.publish(behavior_command("STAND_PREP"))
    sim.advance(0.04)
    assert told == sim.events
    assert [event.text for event in told] == ["STAND -> FREEZE", "FREEZE -> STAND_PREP"]
    times = [event.time for event in told]
    np.testing.assert_allclose(times, [0.04, 0.08], atol=2 * TICK)
    changes = [e for e in sim.summary()["events"] if e["kind"] == "behavior"]
    assert [change["text"] for change in changes] == [event.text for event in told]


def test_a_listener_hears_each_run_begin_and_the_close():
    class Listener:
        def __init__(self):
            self.heard = []

        def begin(self, sim):
            self.heard.append((sim.time, sim.scenario.seed))

        def close(self):
            self.heard.append("closed")

    listener = Listener()
    with AtlasSimulation(listeners=[listener, object()]) as sim:
        sim.advance(0.01)
        sim.reset()  # The run goes on.
        sim.reset(seed=3)
    assert listener.heard == [(0.0, 0), (0.0, 3), "closed"]


def test_a_listeners_error_is_raised_and_loses_no_event(tmp_path):
    error = RuntimeError("of the caller")

    def on_event(event):
        raise error

    sim = AtlasSimulation(
        Scenario(),
        listeners=[SimpleNamespace(event=on_event)],
        log=tmp_path / "run.mcap",
    )
    sim.diagram.GetInputPort("atlas_command").FixValue(
        sim.context, AtlasCommand(position=[0.0])
    )
    sim.publish(behavior_command(Behavior.WALK))
    with pytest.raises(RuntimeError) as caught:
        sim.advance(0.1)
    assert caught.value is error
    kinds = [event.kind for event in sim.events]
    assert {"refusal", "behavior"} <= set(kinds)
    sim.close()
    assert [event.kind for event in read_log(tmp_path / "run.mcap").events] == kinds


def test_messages_after_the_last_advance_are_in_events_and_log(tmp_path):
    with AtlasSimulation(log=tmp_path / "run.mcap") as sim:
        sim.advance(0.01)
        sim.publish(AtlasCommand())
        with pytest.raises(InvalidMessageError):
            sim.publish(AtlasCommand(position=[0.0]))
        assert [event.kind for event in sim.events] == ["refusal"]
    log = read_log(tmp_path / "run.mcap")
    assert [command.message for command in log.commands] == [AtlasCommand()]
    assert [event.kind for event in log.events] == ["refusal"]


def test_a_scenario_is_copied():
    scenario = Scenario(start=Start(position=[0.5, 0.0]))
    sim = AtlasSimulation(scenario)
    scenario.start.position[:] = [9.0, 9.0]
    sim.reset()
    assert abs(sim.pelvis_pose.translation()[0] - 0.5) < 0.5


def test_a_scenario_is_checked_before_anything_is_built():
    with pytest.raises(ScenarioError, match="physics_step"):
        AtlasSimulation(Scenario(physics_step=0.011))


@pytest.mark.parametrize("behavior", ["STAND_PREP", "USER"])
def test_a_run_begins_in_the_scenarios_behavior(behavior):
    sim = AtlasSimulation(Scenario(initial_behavior=behavior))
    assert sim.current_behavior is Behavior[behavior]
    sim.advance(0.02)
    assert sim.current_behavior is Behavior[behavior]
    users = 255 if behavior == "USER" else 0
    assert list(sim.atlas_state.k_effort) == [users] * 28
    assert sim.events == []


# ---- user mode in the whole robot ----------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("physics_step", [0.0005, 0.003])
def test_the_tutorials_gains_are_stable_in_the_whole_robot(physics_step):
    sim = AtlasSimulation(Scenario(initial_behavior="USER", physics_step=physics_step))
    n = sim.robot.num_joints
    # The tutorial's gains are the default ones, and this on every joint.
    sim.publish(AtlasCommand(kp_velocity=[50.0] * n, kd_position=[0.0] * n))
    velocities, efforts = [], []
    indices = sim.robot.indices(sim.plant)
    q = sim.plant.num_positions()

    def watch(root):
        state = sim.diagram.GetOutputPort("state").Eval(root)
        velocities.append(np.abs(state[q + indices.v]).max())
        efforts.append(sim.diagram.GetOutputPort("effort").Eval(root).copy())

    sim.simulator.set_monitor(watch)
    sim.advance(1.0)
    assert len(velocities) > 1.0 / physics_step
    landing = round(0.3 / physics_step)
    # It lands on its feet, sinks a little, and nothing rings.
    assert max(velocities) < 1.5
    assert max(velocities[landing:]) < 0.2
    assert (np.abs(efforts) <= sim.robot.effort_limit).all()
    assert not sim.has_fallen


def test_steps_read_as_they_were_given(tmp_path):
    path = tmp_path / "run.mcap"
    with AtlasSimulation(Scenario(physics_step=0.003), log=path) as sim:
        sim.advance(0.02)
        summary = sim.summary()
    assert (summary["physics_step"], summary["control_period"]) == (0.003, 0.009)
    assert summary["configuration"]["plant"]["time_step"] == 0.003
    header = read_log(path).header
    assert header.control_period == 0.009
    assert header.scenario["physics_step"] == 0.003
