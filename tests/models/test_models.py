"""The URDF files as Drake loads them: actuators, frames, contact and symmetry."""

from types import SimpleNamespace

import numpy as np
import pytest
from pydrake.geometry import Role, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from atlas_drake.robot import load_robot

LEG = ("leg_hpz", "leg_hpx", "leg_hpy", "leg_kny", "leg_aky", "leg_akx")
ARM = ("arm_shy", "arm_shx", "arm_ely", "arm_elx", "arm_wry", "arm_wrx")
JOINT_ORDER = (
    *("back_bkz", "back_bky", "back_bkx", "neck_ry"),
    *(f"l_{joint}" for joint in LEG),
    *(f"r_{joint}" for joint in LEG),
    *(f"l_{joint}" for joint in ARM),
    *(f"r_{joint}" for joint in ARM),
)
LEG_EFFORTS = (110, 180, 260, 220, 700, 90)
ARM_EFFORTS = (212, 170, 114, 114, 114, 60)
EFFORT_LIMITS = (124.016, 206.843, 200, 5, *(LEG_EFFORTS * 2), *(ARM_EFFORTS * 2))
MOST_COLLISION_CANDIDATES = 60
"""Candidate pairs cost time at every step; this many are looked at today."""
STAND_PREP = load_robot().stand_prep

REFLECTION = np.diag([1.0, -1.0, 1.0])
FRAMES = {
    "imu": ("pelvis", [0.0599, 0.0, -0.01415]),
    "l_sole": ("l_foot", [0.048, 0.0, -0.081119]),
    "r_sole": ("r_foot", [0.048, 0.0, -0.081119]),
}


@pytest.fixture(params=["atlas", "atlas_v3"], scope="module")
def robot(request):
    """Each robot in turn in a diagram of its own; each test sets the pose it needs."""
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.002)
    instance = load_robot(request.param).add_to(plant)
    plant.Finalize()
    diagram = builder.Build()
    root = diagram.CreateDefaultContext()
    context = plant.GetMyMutableContextFromRoot(root)
    query_port = plant.get_geometry_query_input_port()

    def set_pose(positions):
        q = np.zeros(plant.num_positions())
        q[0] = 1.0
        for name, value in zip(JOINT_ORDER, positions, strict=True):
            q[plant.GetJointByName(name).position_start()] = value
        plant.SetPositions(context, q)

    def colliding():
        """Returns the pairs of links that penetrate each other."""
        query = query_port.Eval(context)
        frame = query.inspector().GetFrameId
        return [
            tuple(
                sorted(
                    plant.GetBodyFromFrameId(frame(g)).name() for g in (p.id_A, p.id_B)
                )
            )
            for p in query.ComputePointPairPenetration()
        ]

    return SimpleNamespace(
        diagram=diagram,
        plant=plant,
        inspector=scene_graph.model_inspector(),
        bodies=[*map(plant.get_body, plant.GetBodyIndices(instance))],
        context=context,
        set_pose=set_pose,
        colliding=colliding,
    )


def mirror_sign(joint):
    return 1 if joint.endswith("y") else -1  # Ends in its axis: x, y or z.


def other_side(name):
    return {"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:]


def test_actuators_come_in_message_order_on_one_floating_tree(robot):
    plant = robot.plant
    actuators = [*map(plant.get_joint_actuator, plant.GetJointActuatorIndices())]
    assert tuple(one.name() for one in actuators) == JOINT_ORDER
    assert tuple(one.joint().name() for one in actuators) == JOINT_ORDER
    assert tuple(one.effort_limit() for one in actuators) == EFFORT_LIMITS
    assert (plant.num_positions(), plant.num_velocities()) == (35, 34)
    assert plant.num_bodies() == 1 + 29  # Nothing but the world and the links.
    (base,) = plant.GetFloatingBaseBodies()
    assert plant.get_body(base).name() == "pelvis"


def test_frames_are_where_the_original_has_them(robot):
    for name, (link, position) in FRAMES.items():
        frame = robot.plant.GetFrameByName(name)
        assert frame.body().name() == link
        X_LF = frame.CalcPoseInBodyFrame(robot.context)
        np.testing.assert_array_equal(X_LF.translation(), position)
        assert X_LF.rotation().IsExactlyIdentity()


def test_feet_touch_by_soles_with_their_friction(robot):
    for side in "lr":
        foot = robot.plant.GetBodyByName(f"{side}_foot")
        frame = robot.plant.GetBodyFrameIdOrThrow(foot.index())
        geometries = robot.inspector.GetGeometries(frame, Role.kProximity)
        assert len(geometries) > 20
        for geometry in geometries:
            assert isinstance(robot.inspector.GetShape(geometry), Sphere)
            properties = robot.inspector.GetProximityProperties(geometry)
            friction = properties.GetProperty("material", "coulomb_friction")
            assert friction.static_friction() == friction.dynamic_friction() == 0.9
            assert not properties.HasGroup("hydroelastic")


def test_every_link_is_drawn_and_few_pairs_of_shapes_can_collide(robot):
    for body in robot.bodies:
        frame = robot.plant.GetBodyFrameIdOrThrow(body.index())
        for role in (Role.kIllustration, Role.kPerception):
            drawn = robot.inspector.NumGeometriesForFrameWithRole(frame, role)
            assert drawn == 1, body.name()
    candidates = robot.inspector.GetCollisionCandidates()
    assert 0 < len(candidates) <= MOST_COLLISION_CANDIDATES


def test_limbs_mirror_each_other_in_motion(robot):
    joints = [robot.plant.GetJointByName(name) for name in JOINT_ORDER]
    pose = np.random.default_rng(0).uniform(
        [joint.position_lower_limit() for joint in joints],
        [joint.position_upper_limit() for joint in joints],
    )
    by_name = dict(zip(JOINT_ORDER, pose, strict=True))
    mirrored = [mirror_sign(name) * by_name[other_side(name)] for name in JOINT_ORDER]

    def poses(positions):
        robot.set_pose(positions)
        evaluate = robot.plant.EvalBodyPoseInWorld
        return {body.name(): evaluate(robot.context, body) for body in robot.bodies}

    before, after = poses(pose), poses(mirrored)
    assert len(before) == 29
    for link, X_WL in before.items():
        R = REFLECTION @ X_WL.rotation().matrix() @ REFLECTION
        image = RigidTransform(np.c_[R, REFLECTION @ X_WL.translation()])
        assert after[other_side(link)].IsNearlyEqualTo(image, 1e-12), link


def test_limbs_mirror_each_other_in_limits_and_inertia(robot):
    for name in (name for name in JOINT_ORDER if name.startswith("l_")):
        left, right = map(robot.plant.GetJointByName, (name, other_side(name)))
        ends = (left.position_lower_limit(), left.position_upper_limit())
        image = sorted(mirror_sign(name) * end for end in ends)
        assert [right.position_lower_limit(), right.position_upper_limit()] == image
        M_left, M_right = (
            joint.child_body().default_spatial_inertia() for joint in (left, right)
        )
        assert M_left.get_mass() == M_right.get_mass()
        np.testing.assert_array_equal(M_right.get_com(), REFLECTION @ M_left.get_com())
        I_left, I_right = (
            M.CalcRotationalInertia().CopyToFullMatrix3() for M in (M_left, M_right)
        )
        image = REFLECTION @ I_left @ REFLECTION
        np.testing.assert_allclose(I_right, image, atol=1e-15)


def test_no_self_collision_from_zero_to_stand_prep_and_within_reach_of_a_walk(robot):
    poses = [share * STAND_PREP for share in np.linspace(0.0, 1.0, 21)]
    # How far joints stray from the stand-prep pose in a walk [rad].
    reach = dict.fromkeys(JOINT_ORDER, 0.15)
    for side in "lr":
        leg = zip(LEG, (0.05, 0.05, 0.60, 0.50, 0.50, 0.15), strict=True)
        reach |= {f"{side}_{joint}": value for joint, value in leg}
    spans = np.array([reach[name] for name in JOINT_ORDER])
    generator = np.random.default_rng(1)
    poses += [STAND_PREP + generator.uniform(-spans, spans) for _ in range(200)]
    for pose in poses:
        robot.set_pose(pose)
        assert robot.colliding() == []


def test_legs_collide_when_crossed(robot):
    pose = STAND_PREP.copy()
    pose[JOINT_ORDER.index("l_leg_hpx")] = -0.3
    pose[JOINT_ORDER.index("r_leg_hpx")] = 0.3
    robot.set_pose(pose)
    assert ("l_lleg", "r_lleg") in robot.colliding()


@pytest.mark.parametrize(
    ("pair", "arm"),
    [
        (("l_hand", "utorso"), (-0.12, -0.37, 3.13, 2.31, 2.15, 0.35)),
        (("head", "l_hand"), (0.61, 1.47, 0.05, 2.03, 3.08, 1.08)),
        (("l_hand", "pelvis"), (-0.34, -1.29, 3.08, 1.35, 0.02, 0.64)),
        (("l_hand", "l_uleg"), (0.62, -1.23, 2.95, 1.27, 2.27, -0.35)),
    ],
)
def test_hand_collides_with_what_it_can_reach(robot, pair, arm):
    pose = np.zeros(28)
    first = JOINT_ORDER.index("l_arm_shy")
    pose[first : first + len(arm)] = arm
    robot.set_pose(pose)
    assert pair in robot.colliding()
