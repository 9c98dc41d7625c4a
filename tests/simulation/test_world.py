"""Models beside the robot: contacts, states, resets, gantry, estimator and noise."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pydrake.common.schema import Transform
from pydrake.geometry import Box, Role, SceneGraphConfig, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import CoulombFriction
from pydrake.multibody.tree import (
    PrismaticJoint,
    SpatialInertia,
    UnitInertia,
)

from atlas_drake import (
    AtlasSimulation,
    Block,
    Scenario,
    Start,
    load_scenario,
    read_log,
)
from atlas_drake.clients.film.replay import make_replay
from atlas_drake.diagrams.atlas_station import make_atlas_station
from atlas_drake.scenario import Jitter
from atlas_drake.worlds.models import Model
from atlas_drake.worlds.world import WorldError

EXAMPLES = Path(__file__).parents[2] / "examples/scenarios"
FRICTION = CoulombFriction(0.5, 0.5)


def body(plant, name, shape, mass, link=None):
    instance = plant.AddModelInstance(name)
    inertia = SpatialInertia(mass, np.zeros(3), UnitInertia.SolidSphere(0.1))
    added = plant.AddRigidBody(link or name, instance, inertia)
    plant.RegisterCollisionGeometry(added, RigidTransform(), shape, name, FRICTION)
    plant.RegisterVisualGeometry(
        added, RigidTransform(), shape, name, np.array([1.0, 0.0, 0.0, 1.0])
    )
    return added


def ball(plant):
    """A ball in the air; its link has a name of the robot's."""
    added = body(plant, "ball", Sphere(0.1), 3.0, link="pelvis")
    plant.SetDefaultFloatingBaseBodyPose(added, RigidTransform([2.0, 0.0, 1.4]))


def boxes_at_rest(plant):
    """A box on the ground and one on a table, with no more than friction."""
    plant.RegisterCollisionGeometry(
        plant.world_body(),
        RigidTransform([2.0, 0.0, 0.7]),
        Box(0.7, 0.9, 0.04),
        "table",
        FRICTION,
    )
    for name, p_WB in REST.items():
        inertia = SpatialInertia.SolidBoxWithMass(3.0, 0.3, 0.3, 0.3)
        box = plant.AddRigidBody(name, plant.AddModelInstance(name), inertia)
        shape = Box(0.3, 0.3, 0.3)
        plant.RegisterCollisionGeometry(box, RigidTransform(), shape, name, FRICTION)
        plant.SetDefaultFloatingBaseBodyPose(box, RigidTransform(np.array(p_WB)))


REST = {"on_table": [2.0, 0.1, 0.87], "on_ground": [2.0, 2.0, 0.15]}


def slider(plant):
    """A block on a motor, named as a joint of the robot."""
    added = body(plant, "slider", Box(0.2, 0.2, 0.2), 5.0)
    joint = PrismaticJoint(
        "l_leg_kny", plant.world_frame(), added.body_frame(), np.array([1.0, 0.0, 0.0])
    )
    joint = plant.AddJoint(joint)
    joint.set_default_translation(3.0)
    plant.AddJointActuator("l_leg_kny", joint)


def plate(plant):
    """A plate that the robot stands on."""
    added = body(plant, "plate", Box(1.0, 1.0, 0.04), 20.0)
    X_WB = RigidTransform([0.0, 0.0, 0.02])
    plant.WeldFrames(plant.world_frame(), added.body_frame(), X_WB)


def throw(sim):
    plant = sim.plant
    thrown = plant.GetBodyByName("pelvis", plant.GetModelInstanceByName("ball"))
    plant.SetFreeBodySpatialVelocity(
        plant.GetMyMutableContextFromRoot(sim.context),
        thrown,
        SpatialVelocity(np.zeros(3), np.array([-5.0, 0.0, 1.5])),
    )


@pytest.mark.parametrize(
    "fields",
    [
        {
            "state": "estimated",
            "noise": "rough",
            "jitter": Jitter(mass=0.05, joints=0.02),
        },
        {"start": Start(on_gantry=True), "initial_behavior": "FREEZE"},
    ],
    ids=["estimated", "gantry"],
)
def test_bodies_without_contact_leave_the_robots_motion_unchanged(fields):
    scenario = Scenario(seed=3, **fields)
    alone = AtlasSimulation(scenario)
    among = AtlasSimulation(scenario, world=[ball, slider])
    for sim in (alone, among):
        sim.apply_push("utorso", [30.0, 0.0, 0.0], 0.05)
        sim.advance(0.1)
    for name in ("state", "behavior_state", "effort", "foot_wrenches", "peaks"):
        mine, other = alone.output(name), among.output(name)
        # The plant solves for all models at once.
        np.testing.assert_allclose(other, mine, rtol=1e-6, atol=1e-8, err_msg=name)
    num_alone = alone.output("plant_state").size
    assert among.output("plant_state").size == num_alone + 13 + 2
    assert among.output("slider.state").size == 2
    # Of a fall in time steps.
    step = scenario.physics_step
    number = math.ceil(0.1 / step)
    drop = 9.81 * step**2 * number * (number + 1) / 2
    assert among.output("ball.state")[6] == pytest.approx(1.4 - drop, abs=1e-6)


@pytest.mark.slow
def test_the_robot_feels_a_ball_and_a_reset_puts_it_back():
    sim = AtlasSimulation(world=[ball])
    start = sim.output("ball.state").copy()
    throw(sim)
    sim.advance(0.4)
    state = sim.output("state")
    indices, robot = sim.robot.indices(sim.plant), sim.robot
    hit = state[robot.num_joints + 7 :][indices.pelvis.velocity.start - 35]
    assert hit < -0.05
    sim.advance(1.0)
    assert not sim.has_fallen
    sim.reset()
    np.testing.assert_array_equal(sim.output("ball.state"), start)
    throw(sim)
    sim.advance(0.1)
    sim.reset(seed=0)
    assert sim.time == 0.0
    np.testing.assert_array_equal(sim.output("ball.state"), start)


def test_foot_wrenches_count_contact_with_any_body():
    sim = AtlasSimulation(world=[plate])
    sim.advance(0.6)
    wrenches = sim.output("foot_wrenches").reshape(2, 6)
    weight = sim.robot.mass * 9.81
    assert wrenches[:, 5].sum() == pytest.approx(weight, rel=0.05)
    results = sim.output("contact_results")
    feet = {foot.body for foot in sim.robot.file.feet}
    touched = set()
    for k in range(results.num_point_pair_contacts()):
        info = results.point_pair_contact_info(k)
        pair = {
            sim.plant.get_body(index).name()
            for index in (info.bodyA_index(), info.bodyB_index())
        }
        if pair & feet:
            touched |= pair - feet
    assert touched == {"plate"}
    assert not sim.has_fallen


def test_boxes_rest_where_they_lie():
    sim = AtlasSimulation(world=[boxes_at_rest])
    sim.advance(0.3)
    context = sim.plant.GetMyContextFromRoot(sim.context)
    for name, p_WB in REST.items():
        box = sim.plant.GetBodyByName(name)
        X_WB = sim.plant.EvalBodyPoseInWorld(context, box)
        np.testing.assert_allclose(X_WB.translation(), p_WB, atol=5e-4)


def test_the_soles_meet_the_ground_with_drakes_own_dissipation():
    sim = AtlasSimulation()
    # That of the Context: it has Drake's defaults filled in.
    inspector = sim.output("query_object").inspector()
    foot = sim.plant.GetBodyByName(sim.robot.file.feet[0].body)

    def dissipation(body):
        frame = sim.plant.GetBodyFrameIdOrThrow(body.index())
        shape = inspector.GetGeometries(frame, Role.kProximity)[0]
        properties = inspector.GetProximityProperties(shape)
        return properties.GetProperty("material", "hunt_crossley_dissipation")

    mean = 0.5 * (dissipation(foot) + dissipation(sim.plant.world_body()))
    drakes = SceneGraphConfig().default_proximity_properties
    assert mean == drakes.hunt_crossley_dissipation


def table(height, x=0.0):
    """Adds a table top without legs; its upper side is at a height [m]."""

    def add(plant):
        pose = RigidTransform([x, 0.0, height - 0.15])
        top = Box(1.0, 1.0, 0.3)
        plant.RegisterCollisionGeometry(
            plant.world_body(), pose, top, "table", FRICTION
        )

    return add


PLATFORM = """<sdf version="1.9"><model name="platform"><link name="platform">
  <collision name="box"><geometry><box><size>2 2 0.4</size></box></geometry></collision>
</link></model></sdf>"""


@pytest.mark.slow
def test_the_robot_begins_on_what_is_below_it(tmp_path):
    file = tmp_path / "platform.sdf"
    file.write_text(PLATFORM)
    X_WB = Transform(RigidTransform([0.0, 0.0, 0.1]))
    model = Model(file=str(file), X_WB=X_WB, weld=True)
    block = Block(position=[0.0, 0.0, 0.2])
    flat = AtlasSimulation().pelvis_pose.translation()[2]
    for sim in (
        AtlasSimulation(Scenario(models=[model])),
        AtlasSimulation(world=[table(0.3)]),
        # The higher one counts, be it terrain or not.
        AtlasSimulation(Scenario(terrain=[block], models=[model])),
    ):
        height = sim.pelvis_pose.translation()[2] - flat
        assert height == pytest.approx(0.3, abs=1e-4)
    sim.advance(0.3)
    assert not sim.has_fallen
    sim.reset(pose=Start(position=[3.0, 0.0]))
    assert sim.pelvis_pose.translation()[2] == pytest.approx(flat, abs=1e-4)
    held = AtlasSimulation(
        Scenario(
            start=Start(on_gantry=True),
            initial_behavior="FREEZE",
            models=[model],
        )
    )
    height = held.pelvis_pose.translation()[2] - flat
    assert height == pytest.approx(0.4, abs=1e-4)
    station = make_atlas_station(world=[table(0.3)])
    plant = station.GetSubsystemByName("plant")
    pelvis = plant.GetBodyByName("pelvis")
    context = plant.CreateDefaultContext()
    height = pelvis.EvalPoseInWorld(context).translation()[2]
    assert height == pytest.approx(flat + 0.3, abs=1e-4)


def test_a_robot_that_would_begin_inside_a_model_is_refused():
    with pytest.raises(WorldError, match=r"of atlas would begin 0\.\d+ m inside table"):
        AtlasSimulation(world=[table(1.0)])
    # Where it begins elsewhere, nothing is in its way.
    aside = Scenario(start=Start(position=[-2.0, 0.0]))
    sim = AtlasSimulation(aside, world=[table(1.0), ball])
    sim.apply_push("utorso", [5.0, 0.0, 0.0], 1.0)
    sim.advance(0.1)
    inside = replace(aside, start=Start(position=[0.0, 0.0]))
    before = sim.output("plant_state").copy(), sim.output("commands"), len(sim.events)
    for begin in (
        lambda: sim.reset("USER", pose=inside.start),
        lambda: sim.reset(seed=2, pose=inside.start),
        lambda: sim.restart(inside),
    ):
        with pytest.raises(WorldError, match="inside table: put one of them elsewhere"):
            begin()
        np.testing.assert_array_equal(sim.output("plant_state"), before[0])
        assert sim.output("commands") is before[1]
        assert len(sim.events) == before[2]
        assert sim.time == pytest.approx(0.1)
        assert sim.scenario == aside.resolved()
    # The push still acts.
    forces = sim.plant.get_applied_spatial_force_input_port()
    (push,) = forces.Eval(sim.plant.GetMyContextFromRoot(sim.context))
    np.testing.assert_array_equal(push.F_Bq_W.translational(), [5.0, 0.0, 0.0])


def second_head(plant):
    """A body that is free, in the robot's own model."""
    own = plant.GetModelInstanceByName("atlas")
    plant.AddRigidBody("head2", own, SpatialInertia.SolidSphereWithMass(1.0, 0.1))


@pytest.mark.parametrize(
    ("world", "problem"),
    [
        ([3], "world must be a list of callables"),
        (3, "world must be a list of callables"),
        (None, "world must be a list of callables"),
        ([lambda p: p.Finalize()], "finalize"),
        ([second_head], "must not add bodies that move to the model of atlas"),
    ],
)
def test_a_world_that_cannot_be_added_is_refused(world, problem):
    with pytest.raises(WorldError, match=problem):
        AtlasSimulation(world=world)


@pytest.mark.slow
def test_a_log_holds_how_the_world_moved_and_replay_shows_it(tmp_path):
    file = tmp_path / "run.mcap"
    scenario = load_scenario(EXAMPLES / "ball.yaml")
    with AtlasSimulation(scenario, world=[ball_beside], log=file) as sim:
        sim.advance(0.3)
        last = sim.output("plant_state").copy()
        names = sim.plant.GetPositionNames()
    log = read_log(file)
    assert log["world.q"].shape[1] == 14
    assert log["world.v"].shape[1] == 12
    labels = log.schema.columns["world.q"].elements
    for label, value in zip(labels, log["world.q"][-1], strict=True):
        assert value == pytest.approx(last[names.index(label)], abs=0.03)

    def shown(world):
        diagram = make_replay(log, world=world)
        context = diagram.CreateDefaultContext()
        context.SetTime(log.time[-1])
        station = diagram.GetSubsystemByName("station")
        query = station.GetOutputPort("query_object").Eval(
            station.GetMyContextFromRoot(context)
        )
        inspector = query.inspector()
        return {
            inspector.GetName(frame): query.GetPoseInWorld(frame).translation()
            for frame in inspector.GetAllFrameIds()
        }

    for world in ([], [ball_beside]):
        poses = shown(world)
        column = labels.index(next(n for n in labels if "ball_x" in n))
        assert poses["ball::ball"][0] == log["world.q"][-1][column]
        assert poses["ball::ball"][0] < 1.3
        assert ("beside::ball" in poses) == bool(world)
    assert poses["beside::ball"][2] < 0.9


def ball_beside(plant):
    added = body(plant, "beside", Sphere(0.1), 3.0, link="ball")
    plant.SetDefaultFloatingBaseBodyPose(added, RigidTransform([0.0, 2.0, 1.0]))
