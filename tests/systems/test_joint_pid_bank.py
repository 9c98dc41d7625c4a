"""The joint PID bank: the reference's formula at steady state, per joint, in bounds."""

import dataclasses

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake.control.joints.joint_pid import InverseMass
from atlas_drake.messages import Behavior
from atlas_drake.messages.commands import commands_at_start
from atlas_drake.systems.joint_pid_bank import JointPidBank

PHYSICS_STEP, CONTROL_PERIOD = 0.001, 0.002
"""[s]"""
SETTLED = 0.2
"""Long after the estimate of outer forces has settled [s]."""


class Bench:
    """A bank on its own whose inputs the test holds."""

    def __init__(self, robot, plant, system):
        self.robot, self.system = robot, system
        self.indices = robot.indices(plant)
        self.num_positions = plant.num_positions()
        self.simulator = Simulator(self.system)
        self.command = commands_at_start(robot, Behavior.USER).joints
        self.num_states = self.num_positions + plant.num_velocities()
        self.hold("behavior_effort", np.zeros(robot.num_joints))
        # Away from all end stops.
        margin = 0.15 * (robot.position_upper - robot.position_lower)
        lower, upper = robot.position_lower + margin, robot.position_upper - margin
        self.move(np.clip(robot.stand_prep, lower, upper))
        self.order()

    def hold(self, port, value):
        context = self.simulator.get_mutable_context()
        self.system.GetInputPort(port).FixValue(context, value)

    def move(self, q, v=0.0):
        """Joints at q [rad] that go at v [rad/s] all the time."""
        state = np.zeros(self.num_states)
        state[0] = 1.0
        state[self.indices.q] = q
        state[self.num_positions + self.indices.v] = v
        self.q, self.v, self.state = q, v, state
        self.hold("state", state)

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
    indices, count = robot.indices(plant), plant.num_positions()
    return plant, JointPidBank(robot, indices, count, PHYSICS_STEP, CONTROL_PERIOD)


@pytest.fixture
def bench(robot, parts):
    return Bench(robot, *parts)


@pytest.fixture
def random():
    return np.random.default_rng(11)


def small(bench, random, scale=0.01):
    """A command that is at work everywhere and far from the motors' limits."""
    share = bench.robot.effort_limit
    bench.move(bench.q + random.uniform(-0.1, 0.1, 28), random.uniform(-0.2, 0.2, 28))
    bench.order(
        position=bench.q + random.uniform(-0.1, 0.1, 28),
        velocity=random.uniform(-0.2, 0.2, 28),
        effort=scale * share * random.uniform(-1.0, 1.0, 28),
        kp_position=share * random.uniform(0.1, 1.0, 28),
        kd_position=scale * share * random.uniform(0.1, 1.0, 28),
        kp_velocity=scale * share * random.uniform(0.1, 1.0, 28),
    )


def test_the_formula_holds_at_steady_velocity_for_each_joint_of_the_user(bench, random):
    small(bench, random)
    k = np.array([0, 1, 128, 255] * 7, dtype=float)
    bench.order(k_effort=k)
    bench.hold("behavior_effort", random.uniform(-5.0, 5.0, 28))
    bench.run(SETTLED)
    expected = np.where(k > 0, bench.written_law(), 0.0)
    np.testing.assert_allclose(bench.effort, expected, rtol=1e-6, atol=1e-6)
    # Without damping from the first step on, at the instant of the command.
    bench.order(kd_position=0.0, kp_velocity=0.0, k_effort=255.0)
    np.testing.assert_allclose(bench.effort, bench.written_law(), atol=1e-9)


def test_the_law_knows_how_the_behaviors_share_moves_the_joints(bench):
    # From rest, and at once: what the behavior does now is no surprise to the damper.
    own = np.linspace(-3.0, 3.0, 28)
    bench.hold("behavior_effort", own)
    inverse_mass = InverseMass(bench.robot)
    response = PHYSICS_STEP * inverse_mass.evaluate(
        inverse_mass.create_context(), bench.state[: bench.num_positions]
    )
    bench.order(kp_position=0.0, kd_position=0.0, kp_velocity=20.0, effort=-own)
    for k in (51.0, 204.0):
        share = k / 255.0
        bench.order(k_effort=k)
        # User and behavior together move the joints by this, in a step.
        total = share * bench.effort + (1.0 - share) * own
        expected = -own - 20.0 * (response @ total)
        np.testing.assert_allclose(bench.effort, expected, rtol=1e-6, atol=1e-6)


def test_a_joint_taken_at_rest_keeps_its_effort(bench, random):
    # Whatever balanced the behavior's efforts balances the user's; a damper that takes
    # them for unbalanced would take most of them away.
    own = random.uniform(-20.0, 20.0, 28)
    bench.hold("behavior_effort", own)
    bench.order(k_effort=0.0)
    bench.run(0.01)
    # In USER the behavior gives nothing from the tick on at which the user takes over.
    bench.hold("behavior_effort", np.zeros(28))
    bench.order(
        kp_position=0.0, kd_position=0.0, kp_velocity=50.0, k_effort=255.0, effort=own
    )
    np.testing.assert_allclose(bench.effort, own, rtol=1e-9)


def test_the_law_is_prepared_anew_when_joints_have_moved(bench):
    def prepared():
        return bench.simulator.get_context().get_abstract_state(0).get_value()

    ticks = 5 * CONTROL_PERIOD
    bench.run(ticks)
    first = prepared()
    bench.move(bench.q + 0.09)
    bench.run(ticks)
    assert prepared() is first
    q = bench.q.copy()
    q[-1] -= 0.2
    bench.move(q)
    bench.run(ticks)
    np.testing.assert_array_equal(prepared().q, q)


def test_setpoints_act_within_the_joints_limits_and_not_outward_at_them(bench, robot):
    for limit, out in ((robot.position_upper, 1.0), (robot.position_lower, -1.0)):
        bench.order(kp_position=0.1, kd_position=0.0, kp_velocity=0.0)
        bench.order(position=100.0 * out)
        np.testing.assert_allclose(bench.effort, 0.1 * (limit - bench.q))
        for beyond in (0.0, 0.3):
            bench.order(position=limit + beyond * out, velocity=out, kp_velocity=0.1)
            outward = bench.effort.copy()
            bench.order(position=limit, velocity=0.0)
            np.testing.assert_allclose(outward, bench.effort, rtol=1e-9)
        bench.order(velocity=-out)
        assert (out * bench.effort < out * outward).all()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_limit_is_left_to_the_blend(bench, sign):
    # A fifth of this and of what the behavior gives is within the motors' limits.
    error = sign * 0.05
    bench.order(kp_position=1e4, kd_position=0.0, position=bench.q + error, k_effort=51)
    np.testing.assert_allclose(bench.effort, 1e4 * error)


@pytest.mark.parametrize("feed_forward", [1e3, -1e4])
def test_a_motor_at_its_limit_does_not_disturb_its_neighbors(bench, feed_forward):
    # Joints at rest, the motor's as well: it is at its stop.
    effort = np.zeros(28)
    effort[bench.robot.joint_index("r_arm_elx")] = feed_forward
    bench.order(kp_position=200.0, kp_velocity=50.0, position=bench.q + 0.01)
    bench.order(effort=effort)
    bench.run(5.0 * SETTLED)
    np.testing.assert_allclose(bench.effort, bench.written_law(), rtol=1e-4)


def test_the_forecast_knows_a_motor_at_its_limit(bench):
    elbow = bench.robot.joint_index("r_arm_elx")
    limit = bench.robot.effort_limit
    effort, excess, v = np.zeros((3, 28))
    effort[elbow] = -1.5 * limit[elbow]
    excess[elbow] = -0.5 * limit[elbow]
    bench.order(kp_position=0.0, kp_velocity=50.0, effort=effort)
    for k in (255.0, 51.0):
        bench.order(k_effort=k)
        bench.run(SETTLED)
        found = bench.out("user_forecast").excess
        np.testing.assert_allclose(found, excess, atol=0.01)
    # One that moves so fast that its damper takes the excess back is within it.
    v[elbow] = -0.8 * limit[elbow] / 50.0
    bench.move(bench.q, v)
    bench.run(SETTLED)
    np.testing.assert_array_equal(bench.out("user_forecast").excess, np.zeros(28))


def test_the_integral_grows_to_its_clamp_and_returns_at_once(bench):
    bench.order(kp_position=0.0, kd_position=0.0, ki_position=100.0)
    bench.order(i_effort_min=-0.5, i_effort_max=1.5, position=bench.q + 0.1)
    bench.run(0.1)
    # 10 N·m a second, and one step more at the instant itself.
    np.testing.assert_allclose(bench.effort, 1.0, atol=0.02)
    bench.run(0.1)
    np.testing.assert_array_equal(bench.effort, np.full(28, 1.5))
    bench.order(position=bench.q - 0.1)
    bench.run(0.05)
    np.testing.assert_allclose(bench.effort, 1.0, atol=0.02)
    bench.run(0.2)
    np.testing.assert_array_equal(bench.effort, np.full(28, -0.5))


def test_the_integral_holds_still_while_the_behavior_has_the_joint(bench):
    bench.order(kp_position=0.0, kd_position=0.0, ki_position=100.0)
    bench.order(i_effort_min=-5.0, i_effort_max=5.0, position=bench.q + 0.1)
    bench.order(k_effort=np.repeat([0.0, 255.0], 14))
    bench.run(0.1)
    bench.order(k_effort=255.0)
    one_step = 100.0 * 0.1 * PHYSICS_STEP
    np.testing.assert_allclose(bench.effort[:14], one_step)
    np.testing.assert_allclose(bench.effort[14:], 1.0, atol=0.02)
    # Neither forgets while it is the behavior's; a reset clears all.
    bench.order(k_effort=0.0)
    bench.run(0.1)
    bench.order(k_effort=255.0)
    np.testing.assert_allclose(bench.effort[14:], 1.0, atol=0.02)
    bench.system.reset(bench.simulator.get_mutable_context())
    np.testing.assert_allclose(bench.effort, one_step)
