"""The gantry: springs and implicit dampers on the pelvis, stable for any joint law."""

import numpy as np
import pytest
from pydrake.common.value import AbstractValue
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant

from atlas_drake import AtlasCommand, AtlasSimulation, Scenario
from atlas_drake.rotations import rotation_error
from atlas_drake.scenario import Start
from atlas_drake.scenario.scenario import GantryGains
from atlas_drake.systems.gantry import Gantry, implicit_pull

STEP = 0.002
"""Physics step [s]."""

GAINS = GantryGains(damping_ratio=0.8, lowering_speed=0.2, fading_time=2.0)
"""Away from 1, where a factor is as good as a divisor."""

FRICTION = 1.0
"""What the gantry leaves out: friction in the joints, 0.1 N·m·s/rad each [N·m; N]."""


class Hanging:
    """A robot in the air in some motion, its gantry, and the plant's own next step."""

    def __init__(self, robot, plant, gantry):
        random = np.random.default_rng(1)
        self.robot, self.plant, self.gantry = robot, plant, gantry
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
        push = ExternallyAppliedSpatialForce()
        push.body_index = plant.GetBodyByName(robot.file.feet[0].body).index()
        push.p_BoBq_B = np.array([0.1, 0.05, -0.08])
        push.F_Bq_W = SpatialForce([3.0, -2.0, 1.0], [20.0, -30.0, 40.0])
        self.push = push
        state = plant.GetPositionsAndVelocities(self.context)
        for name, value in (
            ("state", state),
            ("actuation", self.actuation),
            ("foot_wrenches", np.zeros(12)),
            ("other_spatial_force", AbstractValue.Make([push])),
        ):
            self.gantry.GetInputPort(name).FixValue(self.own, value)

    @property
    def forces(self):
        return self.gantry.GetOutputPort("applied_spatial_force").Eval(self.own)

    def pelvis_velocity_after_step(self, *forces):
        """As Drake computes it from all forces [rad/s; m/s], shape (6,)."""
        plant, context = self.plant, self.context.Clone()
        plant.get_actuation_input_port().FixValue(context, self.actuation)
        port = plant.get_applied_spatial_force_input_port()
        port.FixValue(context, AbstractValue.Make(list(forces)))
        after = plant.EvalUniquePeriodicDiscreteUpdate(context)
        context.SetDiscreteState(after)
        return plant.EvalBodySpatialVelocityInWorld(context, self.pelvis).get_coeffs()

    def law(self, p_WH, R_WH, velocity):
        """Springs, weight and dampers at a velocity of the pelvis, shape (6,)."""
        mass, w = self.robot.mass, GAINS.natural_frequency
        turn = rotation_error(R_WH, self.X_WP.rotation().matrix())
        pull = mass * w * w * (p_WH - self.X_WP.translation())
        pull[2] += mass * 9.81
        damper = 2.0 * GAINS.damping_ratio * w * mass * velocity[3:]
        return np.concatenate(
            [
                GAINS.rotational_stiffness * turn
                - GAINS.rotational_damping * velocity[:3],
                pull - damper,
            ]
        )


@pytest.fixture(scope="module")
def parts(robot):
    """The plant and the system, whose state is in a context of each test."""
    plant = MultibodyPlant(time_step=STEP)
    # Else the plant's step is no discrete update, see ``atlas_station``.
    plant.SetUseSampledOutputPorts(False)
    robot.add_to(plant)
    plant.Finalize()
    return plant, Gantry(robot, plant, GAINS)


@pytest.fixture
def hanging(robot, parts):
    return Hanging(robot, *parts)


def test_the_pull_follows_the_law_at_the_steps_end_velocity(hanging):
    p_WH = hanging.X_WP.translation() + np.array([0.02, -0.03, 0.01])
    R_WH = RollPitchYaw(0.35, -0.25, 0.8).ToRotationMatrix().matrix()
    hanging.gantry.hold(hanging.own, p_WH, R_WH, 0.1)
    push, own = hanging.forces
    assert push.body_index == hanging.push.body_index
    assert own.body_index == hanging.pelvis.index()
    after = hanging.pelvis_velocity_after_step(push, own)
    expected = hanging.law(p_WH, R_WH, after)
    np.testing.assert_allclose(own.F_Bq_W.get_coeffs(), expected, atol=FRICTION)


def test_the_ground_on_the_soles_counts_as_any_other_force(hanging):
    X_WP = hanging.X_WP
    hanging.gantry.hold(hanging.own, X_WP.translation(), X_WP.rotation().matrix(), 0.1)
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
    own, gantry = hanging.own, hanging.gantry
    gantry.GetInputPort("foot_wrenches").FixValue(own, wrenches)
    none = ExternallyAppliedSpatialForce()
    none.body_index = hanging.push.body_index
    gantry.GetInputPort("other_spatial_force").FixValue(own, AbstractValue.Make([none]))
    _, stood = hanging.forces
    np.testing.assert_allclose(
        stood.F_Bq_W.get_coeffs(), pushed.F_Bq_W.get_coeffs(), rtol=1e-9, atol=1e-6
    )


def test_a_released_gantry_lowers_fades_and_is_off(hanging):
    X_WP = hanging.X_WP
    p_WH, R_WH, drop = X_WP.translation(), X_WP.rotation().matrix(), 0.1
    hanging.gantry.release(hanging.own)
    assert hanging.gantry.state(hanging.own).released is None
    hanging.gantry.hold(hanging.own, p_WH, R_WH, drop)
    hanging.own.SetTime(5.0)
    hanging.gantry.release(hanging.own)
    hanging.own.SetTime(5.2)
    hanging.gantry.release(hanging.own)
    lowering = drop / GAINS.lowering_speed
    for since, lowered, strength in (
        (0.5 * lowering, 0.5 * drop, 1.0),
        (lowering, drop, 1.0),
        (lowering + 0.25 * GAINS.fading_time, drop, 0.75),
    ):
        hanging.own.SetTime(5.0 + since)
        push, own = hanging.forces
        after = hanging.pelvis_velocity_after_step(push, own)
        expected = strength * hanging.law(p_WH - [0.0, 0.0, lowered], R_WH, after)
        found = own.F_Bq_W.get_coeffs()
        np.testing.assert_allclose(found, expected, atol=FRICTION)
    hanging.own.SetTime(5.0 + lowering + 1.001 * GAINS.fading_time)
    assert len(hanging.forces) == 1


def test_a_gantry_that_let_go_gives_no_force(hanging):
    X_WP = hanging.X_WP
    assert len(hanging.forces) == 1
    hanging.gantry.hold(hanging.own, X_WP.translation(), X_WP.rotation().matrix(), 0.1)
    assert len(hanging.forces) == 2
    hanging.gantry.let_go(hanging.own)
    assert len(hanging.forces) == 1


def test_the_pull_solves_its_implicit_law():
    random = np.random.default_rng(4)
    root = random.normal(size=(6, 6))
    response, damping = root @ root.T, random.uniform(0.0, 300.0, 6)
    static, free = random.normal(size=(2, 6))
    pull = implicit_pull(static, damping, free, response)
    np.testing.assert_allclose(pull, static - damping * (free + response @ pull))


@pytest.mark.parametrize(
    ("model", "step", "kp_velocity"),
    [
        ("atlas", 0.002, None),
        ("atlas", 0.001, 1e6),
        ("atlas_v3", 0.002, 1e6),
    ],
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
    if kp_velocity is not None:
        command = AtlasCommand()
        command.kp_velocity = [kp_velocity] * 28
        sim.publish(command)
    begin = sim.pelvis_pose
    sim.advance(0.12)
    state = sim.atlas_state
    assert np.abs(state.angular_velocity.to_array()).max() < 0.1
    assert np.abs(state.velocity).max() < 2.0
    np.testing.assert_allclose(
        sim.pelvis_pose.translation(), begin.translation(), atol=2e-3
    )
