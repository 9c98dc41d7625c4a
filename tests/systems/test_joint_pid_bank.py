"""The joint PID bank: the reference's formula per joint, and its forecast."""

import dataclasses

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake.messages import Behavior
from atlas_drake.messages.commands import commands_at_start
from atlas_drake.systems.joint_pid_bank import JointPidBank

PHYSICS_STEP, CONTROL_PERIOD = 0.001, 0.002
"""[s]"""


class Bench:
    """A bank on its own whose inputs the test holds."""

    def __init__(self, robot, plant, system):
        self.robot, self.system = robot, system
        self.indices = robot.indices(plant)
        self.num_positions = plant.num_positions()
        self.simulator = Simulator(self.system)
        self.command = commands_at_start(robot, Behavior.USER).joints
        self.num_states = self.num_positions + plant.num_velocities()
        self.hold("acceleration", np.zeros(plant.num_velocities()))
        # Away from all end stops.
        margin = 0.15 * (robot.position_upper - robot.position_lower)
        lower, upper = robot.position_lower + margin, robot.position_upper - margin
        self.move(np.clip(robot.stand_prep, lower, upper))
        self.order()

    def hold(self, port, value):
        context = self.simulator.get_mutable_context()
        self.system.GetInputPort(port).FixValue(context, value)

    def move(self, q, v=0.0, acceleration=0.0):
        """Joints at q [rad] that go at v [rad/s], and get faster [rad/s²]."""
        state = np.zeros(self.num_states)
        state[0] = 1.0
        state[self.indices.q] = q
        state[self.num_positions + self.indices.v] = v
        faster = np.zeros(self.num_states - self.num_positions)
        faster[self.indices.v] = acceleration
        self.q, self.v = q, v + PHYSICS_STEP * acceleration
        self.hold("state", state)
        self.hold("acceleration", faster)

    def order(self, **fields):
        """Puts a command in force; what is not given stays."""
        given = {
            name: np.broadcast_to(np.asarray(value, dtype=float), 28).copy()
            for name, value in fields.items()
        }
        self.command = dataclasses.replace(self.command, **given)
        self.hold("joint_command", self.command)

    def run(self, seconds):
        time = self.simulator.get_context().get_time()
        self.simulator.AdvanceTo(time + seconds)

    def out(self, port):
        return self.system.GetOutputPort(port).Eval(self.simulator.get_context())

    @property
    def effort(self):
        return self.out("user_effort")

    def written_law(self):
        """The reference's formula before its limit, with ė = -v."""
        c, robot = self.command, self.robot
        position = np.clip(c.position, robot.position_lower, robot.position_upper)
        return (
            c.kp_position * (position - self.q)
            - c.kd_position * self.v
            + c.kp_velocity * (c.velocity - self.v)
            + c.effort
        )


@pytest.fixture(scope="module")
def parts(robot):
    """The plant and the system, whose state is in a context of each test."""
    plant = robot.plant
    return plant, JointPidBank(robot, plant, PHYSICS_STEP, CONTROL_PERIOD)


@pytest.fixture
def bench(robot, parts):
    return Bench(robot, *parts)


@pytest.fixture
def random():
    return np.random.default_rng(11)


def test_the_formula_holds_for_each_joint_of_the_user(bench, random):
    share = bench.robot.effort_limit
    bench.move(
        bench.q + random.uniform(-0.1, 0.1, 28),
        random.uniform(-0.2, 0.2, 28),
        random.uniform(-50.0, 50.0, 28),
    )
    bench.order(
        position=bench.q + random.uniform(-0.1, 0.1, 28),
        velocity=random.uniform(-0.2, 0.2, 28),
        effort=0.01 * share * random.uniform(-1.0, 1.0, 28),
        kp_position=share * random.uniform(0.1, 1.0, 28),
        kd_position=0.01 * share * random.uniform(0.1, 1.0, 28),
        kp_velocity=0.01 * share * random.uniform(0.1, 1.0, 28),
        k_effort=[0, 1, 128, 255] * 7,
    )
    expected = np.where(bench.command.k_effort > 0, bench.written_law(), 0.0)
    np.testing.assert_allclose(bench.effort, expected, rtol=1e-6, atol=1e-6)
    bench.order(k_effort=0)
    np.testing.assert_array_equal(bench.effort, np.zeros(28))
    np.testing.assert_array_equal(bench.out("motor_law").stiffness, np.zeros(28))


def test_the_motors_law_is_the_same_until_the_command_changes(bench):
    bench.order(kp_position=50.0)
    bench.run(0.01)
    first = bench.out("motor_law")
    bench.move(bench.q + 0.01)
    bench.run(0.01)
    assert bench.out("motor_law") is first
    bench.order(kp_position=60.0)
    assert bench.out("motor_law").stiffness == pytest.approx(60.0)


def test_set_points_act_within_the_joints_limits(bench, robot):
    for limit, out in ((robot.position_upper, 1.0), (robot.position_lower, -1.0)):
        bench.order(kp_position=0.1, kd_position=0.0, kp_velocity=0.0)
        bench.order(position=100.0 * out)
        np.testing.assert_allclose(bench.effort, 0.1 * (limit - bench.q))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_limit_is_left_to_the_blend(bench, sign):
    # A fifth of this and of what the behavior gives is within the motors' limits.
    error = sign * 0.05
    bench.order(kp_position=1e4, kd_position=0.0, position=bench.q + error, k_effort=51)
    np.testing.assert_allclose(bench.effort, 1e4 * error)


def test_the_forecast_knows_a_motor_at_its_limit(bench):
    elbow = bench.robot.joint_index("r_arm_elx")
    limit = bench.robot.effort_limit
    effort, excess, v = np.zeros((3, 28))
    effort[elbow] = -1.5 * limit[elbow]
    excess[elbow] = -0.5 * limit[elbow]
    bench.order(kp_position=0.0, kd_position=0.0, kp_velocity=50.0, effort=effort)
    for k in (255.0, 51.0):
        bench.order(k_effort=k)
        bench.run(0.01)
        found = bench.out("user_forecast").excess
        np.testing.assert_allclose(found, excess, atol=0.01)
    # One that moves so fast that its damper takes the excess back is within it.
    v[elbow] = -0.8 * limit[elbow] / 50.0
    bench.move(bench.q, v)
    bench.run(0.01)
    np.testing.assert_array_equal(bench.out("user_forecast").excess, np.zeros(28))


def test_the_integral_grows_to_its_clamp_and_returns_at_once(bench):
    bench.order(kp_position=0.0, kd_position=0.0, ki_position=100.0)
    bench.order(i_effort_min=-0.5, i_effort_max=1.5, position=bench.q + 0.1)
    bench.run(0.1)
    np.testing.assert_allclose(bench.effort, 1.0, atol=0.03)  # 10 N·m a second.
    bench.run(0.1)
    np.testing.assert_array_equal(bench.effort, np.full(28, 1.5))
    bench.order(position=bench.q - 0.1)
    bench.run(0.05)
    np.testing.assert_allclose(bench.effort, 1.0, atol=0.03)
    bench.run(0.2)
    np.testing.assert_array_equal(bench.effort, np.full(28, -0.5))


def test_the_integral_holds_still_while_the_behavior_has_the_joint(bench):
    bench.order(kp_position=0.0, kd_position=0.0, ki_position=100.0)
    bench.order(i_effort_min=-5.0, i_effort_max=5.0, position=bench.q + 0.1)
    bench.order(k_effort=np.repeat([0.0, 255.0], 14))
    bench.run(0.1)
    bench.order(k_effort=255.0)
    np.testing.assert_array_equal(bench.effort[:14], np.zeros(14))
    np.testing.assert_allclose(bench.effort[14:], 1.0, atol=0.03)
    # Neither forgets while it is the behavior's; a reset clears all.
    bench.order(k_effort=0.0)
    bench.run(0.1)
    bench.order(k_effort=255.0)
    np.testing.assert_allclose(bench.effort[14:], 1.0, atol=0.03)
    bench.system.reset(bench.simulator.get_mutable_context())
    np.testing.assert_array_equal(bench.effort, np.zeros(28))
