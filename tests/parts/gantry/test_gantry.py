"""The gantry: springs and implicit dampers on the pelvis, stable for any joint law."""

import numpy as np
import pytest
from pydrake.common.value import AbstractValue
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.multibody.tree import PdControllerGains

from atlas_drake import AtlasCommand, AtlasSimulation, Scenario
from atlas_drake.control.joints.joint_pid import MotorLaw
from atlas_drake.parts.gantry.gantry import Gantry, GantryGains
from atlas_drake.rotations import rotation_error
from atlas_drake.scenario import Start

STEP = 0.002
"""Physics step [s]."""
GAINS = GantryGains(damping_ratio=0.8, lowering_speed=0.2, fading_time=2.0)
"""Away from 1, where a factor is as good as a divisor."""
DROP = 0.1
"""By which the robot is lowered [m]."""
FRICTION = 1.0
"""What the gantry leaves out: friction in the joints, 0.1 N·m·s/rad each [N·m; N]."""


class Hanging:
    """A robot in the air in some motion, its gantry, and the plant's own next step."""

    def __init__(self, robot):
        random = np.random.default_rng(1)
        self.robot = robot
        self.plant = plant = MultibodyPlant(time_step=STEP)
        # Else the plant's step is no discrete update, see ``atlas_station``.
        plant.SetUseSampledOutputPorts(False)
        robot.add_to(plant)
        plant.Finalize()
        self.gantry = Gantry(robot, plant, GAINS)
        self.own = self.gantry.CreateDefaultContext()
        self.context = plant.CreateDefaultContext()
        self.pelvis = plant.GetBodyByName(robot.file.pelvis)
        q = plant.GetPositions(self.context)
        middle = 0.5 * (robot.position_lower + robot.position_upper)
        q[robot.indices(plant).q] = middle
        plant.SetPositions(self.context, q)
        self.X_WP = RigidTransform(RollPitchYaw(0.3, -0.2, 0.9), [0.4, -0.3, 1.5])
        plant.SetFloatingBaseBodyPoseInWorldFrame(self.context, self.pelvis, self.X_WP)
        v = random.uniform(-0.5, 0.5, plant.num_velocities())
        plant.SetVelocities(self.context, v)
        self.actuation = 0.1 * robot.effort_limit.min() * random.uniform(-1, 1, 28)
        self.motor_law = self.springs(random)
        self.push = ExternallyAppliedSpatialForce()
        foot = plant.GetBodyByName(robot.file.feet[0].body)
        self.push.body_index = foot.index()
        self.push.p_BoBq_B = np.array([0.1, 0.05, -0.08])
        self.push.F_Bq_W = SpatialForce([3.0, -2.0, 1.0], [20.0, 0.0, 40.0])
        state = plant.GetPositionsAndVelocities(self.context)
        for name, value in (
            ("state", state),
            ("actuation", self.actuation),
            ("motor_law", self.motor_law),
            ("foot_wrenches", np.zeros(12)),
            ("other_spatial_force", AbstractValue.Make([self.push])),
        ):
            self.feed(name, value)

    def springs(self, random):
        """Gives the motors springs and dampers within their limits; returns the law."""
        limit, actuators = self.robot.effort_limit, self.plant.GetJointActuatorIndices()
        stiffness, damping, away = random.uniform(0.0, 1.0, (3, 28))
        q = self.plant.GetPositions(self.context)[self.robot.indices(self.plant).q]
        law = MotorLaw(
            2.0 * limit * stiffness, 0.2 * limit * damping, q + 0.2 * away, np.zeros(28)
        )
        for index in actuators:
            motor = self.plant.get_mutable_joint_actuator(index)
            joint = self.robot.joint_index(motor.joint().name())
            gains = PdControllerGains(p=law.stiffness[joint], d=law.damping[joint])
            motor.set_controller_gains(gains)
        return law

    def feed(self, name, value):
        self.gantry.GetInputPort(name).FixValue(self.own, value)

    def hold(self, away=(0.0, 0.0, 0.0)):
        """Holds the pelvis somewhat away from where it is, and turned."""
        self.p_WH = self.X_WP.translation() + away
        self.R_WH = RollPitchYaw(0.35, -0.25, 0.8).ToRotationMatrix().matrix()
        self.gantry.hold(self.own, self.p_WH, self.R_WH, DROP)

    @property
    def forces(self):
        return self.gantry.GetOutputPort("applied_spatial_force").Eval(self.own)

    def law(self, lowered=0.0):
        """Springs, weight and dampers at the velocity after Drake's step, (6,)."""
        plant, context = self.plant, self.context.Clone()
        plant.get_actuation_input_port().FixValue(context, self.actuation)
        position = self.motor_law.position[
            np.argsort(self.robot.indices(plant).actuation)
        ]
        own = self.robot.instance(plant)
        plant.get_desired_state_input_port(own).FixValue(
            context, np.concatenate([position, np.zeros(28)])
        )
        port = plant.get_applied_spatial_force_input_port()
        port.FixValue(context, AbstractValue.Make(list(self.forces)))
        context.SetDiscreteState(plant.EvalUniquePeriodicDiscreteUpdate(context))
        after = plant.EvalBodySpatialVelocityInWorld(context, self.pelvis).get_coeffs()
        mass, w = self.robot.mass, GAINS.natural_frequency
        turn = rotation_error(self.R_WH, self.X_WP.rotation().matrix())
        away = self.p_WH - [0.0, 0.0, lowered] - self.X_WP.translation()
        pull = mass * (w * w * away - 2.0 * GAINS.damping_ratio * w * after[3:])
        pull[2] += mass * 9.81
        moment = GAINS.rotational_stiffness * turn
        return np.append(moment - GAINS.rotational_damping * after[:3], pull)


@pytest.fixture
def hanging(robot):
    return Hanging(robot)


def test_the_pull_follows_the_law_at_the_steps_end_velocity(hanging):
    assert len(hanging.forces) == 1
    hanging.hold(away=[0.02, -0.03, 0.01])
    push, own = hanging.forces
    assert push.body_index == hanging.push.body_index
    assert own.body_index == hanging.pelvis.index()
    np.testing.assert_allclose(own.F_Bq_W.get_coeffs(), hanging.law(), atol=FRICTION)
    hanging.gantry.let_go(hanging.own)
    assert len(hanging.forces) == 1


def test_the_ground_on_the_soles_counts_as_any_other_force(hanging):
    hanging.hold()
    _, pushed = hanging.forces
    # The push as a wrench about the middle of the sole.
    foot = hanging.robot.file.feet[0]
    plant, context = hanging.plant, hanging.context
    X_WB = plant.EvalBodyPoseInWorld(context, plant.GetBodyByName(foot.body))
    sole = plant.GetFrameByName(foot.sole_frame).CalcPoseInWorld(context)
    lever = X_WB @ hanging.push.p_BoBq_B - sole.translation()
    force = hanging.push.F_Bq_W
    moment = force.rotational() + np.cross(lever, force.translational())
    wrenches = np.concatenate([moment, force.translational(), np.zeros(6)])
    hanging.feed("foot_wrenches", wrenches)
    none = ExternallyAppliedSpatialForce()
    none.body_index = hanging.push.body_index
    hanging.feed("other_spatial_force", AbstractValue.Make([none]))
    _, stood = hanging.forces
    np.testing.assert_allclose(
        stood.F_Bq_W.get_coeffs(), pushed.F_Bq_W.get_coeffs(), rtol=1e-9, atol=1e-6
    )


def test_a_released_gantry_lowers_fades_and_is_off(hanging):
    hanging.gantry.release(hanging.own)
    assert hanging.gantry.state(hanging.own).released is None
    hanging.hold()
    for time in (5.0, 5.2):  # The second release has no effect.
        hanging.own.SetTime(time)
        hanging.gantry.release(hanging.own)
    lowering = DROP / GAINS.lowering_speed
    for since, lowered, strength in (
        (0.5 * lowering, 0.5 * DROP, 1.0),
        (lowering, DROP, 1.0),
        (lowering + 0.25 * GAINS.fading_time, DROP, 0.75),
    ):
        hanging.own.SetTime(5.0 + since)
        found = hanging.forces[1].F_Bq_W.get_coeffs()
        expected = strength * hanging.law(lowered)
        np.testing.assert_allclose(found, expected, atol=FRICTION)
    hanging.own.SetTime(5.0 + lowering + 1.001 * GAINS.fading_time)
    assert len(hanging.forces) == 1


@pytest.mark.parametrize(
    ("model", "step", "kp_velocity"),
    [("atlas", 0.002, 0.0), ("atlas", 0.001, 1e6), ("atlas_v3", 0.002, 1e6)],
)
def test_the_pelvis_hangs_still_under_light_and_heavy_damping(model, step, kp_velocity):
    sim = AtlasSimulation(
        Scenario(
            model=model,
            physics_step=step,
            initial_behavior="USER",
            start=Start(on_gantry=True),
        )
    )
    sim.publish(AtlasCommand(kp_velocity=[kp_velocity] * 28))
    begin = sim.pelvis_pose
    sim.advance(0.12)
    state = sim.atlas_state
    assert np.abs(state.angular_velocity.to_array()).max() < 0.1
    assert np.abs(state.velocity).max() < 2.0
    np.testing.assert_allclose(
        sim.pelvis_pose.translation(), begin.translation(), atol=2e-3
    )
