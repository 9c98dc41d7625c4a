"""The URDF files as Drake loads them: actuators, frames, contact and symmetry."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.geometry import Role, Sphere
from pydrake.math import RigidTransform

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
EFFORT_LIMITS = (
    *(124.016, 206.843, 200, 5),
    *(LEG_EFFORTS * 2),
    *(ARM_EFFORTS * 2),
)
MOST_COLLISION_CANDIDATES = 60
"""Candidate pairs cost time at every step; this many are looked at today."""

REFLECTION = np.diag([1.0, -1.0, 1.0])


def _mirror_sign(joint: str) -> int:
    return 1 if joint.endswith("y") else -1  # Ends in its axis: x, y or z.


def _other_side(name: str) -> str:
    swapped = {"l_": "r_", "r_": "l_"}
    return swapped.get(name[:2], name[:2]) + name[2:]


def test_actuators_come_in_message_order(robot):
    assert tuple(a.name() for a in robot.actuators) == JOINT_ORDER
    assert tuple(a.joint().name() for a in robot.actuators) == JOINT_ORDER


def test_effort_limits(robot):
    limits = [actuator.effort_limit() for actuator in robot.actuators]
    np.testing.assert_array_equal(limits, EFFORT_LIMITS)


def test_robot_is_one_floating_tree(robot):
    plant = robot.plant
    assert plant.GetModelInstanceName(robot.instance) == robot.name
    assert plant.num_actuators() == 28
    assert (plant.num_positions(), plant.num_velocities()) == (35, 34)
    assert plant.num_bodies() == 1 + 29  # Nothing but the world and the links.
    assert plant.GetUniqueFloatingBaseBodyOrThrow(robot.instance).name() == "pelvis"


def test_frames(robot):
    context = robot.plant.CreateDefaultContext()
    expected = {
        "imu": ("pelvis", [0.0599, 0.0, -0.01415]),
        "l_sole": ("l_foot", [0.048, 0.0, -0.081119]),
        "r_sole": ("r_foot", [0.048, 0.0, -0.081119]),
    }
    for name, (link, position) in expected.items():
        frame = robot.plant.GetFrameByName(name)
        assert frame.body().name() == link
        X_LF = frame.CalcPoseInBodyFrame(context)
        np.testing.assert_array_equal(X_LF.translation(), position)
        assert X_LF.rotation().IsExactlyIdentity()


def test_feet_are_four_spheres_each_with_their_friction(robot):
    inspector = robot.scene_graph.model_inspector()
    for side in "lr":
        foot = robot.plant.GetBodyByName(f"{side}_foot")
        geometries = robot.plant.GetCollisionGeometriesForBody(foot)
        assert len(geometries) == 4
        for geometry in geometries:
            shape = inspector.GetShape(geometry)
            assert isinstance(shape, Sphere)
            assert shape.radius() == 0.01
            properties = inspector.GetProximityProperties(geometry)
            friction = properties.GetProperty("material", "coulomb_friction")
            assert friction.static_friction() == 0.9
            assert friction.dynamic_friction() == 0.9
            assert not properties.HasGroup("hydroelastic")


def test_every_link_is_drawn(robot):
    inspector = robot.scene_graph.model_inspector()
    for index in robot.plant.GetBodyIndices(robot.instance):
        body = robot.plant.get_body(index)
        frame = robot.plant.GetBodyFrameIdOrThrow(index)
        for role in (Role.kIllustration, Role.kPerception):
            assert inspector.NumGeometriesForFrameWithRole(frame, role) == 1, (
                body.name()
            )


def test_limbs_mirror_each_other_in_motion(robot):
    generator = np.random.default_rng(0)
    lower = [a.joint().position_lower_limit() for a in robot.actuators]
    upper = [a.joint().position_upper_limit() for a in robot.actuators]
    pose = generator.uniform(lower, upper)
    index = {name: i for i, name in enumerate(JOINT_ORDER)}
    mirrored = np.array(
        [_mirror_sign(name) * pose[index[_other_side(name)]] for name in JOINT_ORDER]
    )

    def poses(positions: np.ndarray) -> dict[str, RigidTransform]:
        robot.set_pose(positions, RigidTransform())
        bodies = map(robot.plant.get_body, robot.plant.GetBodyIndices(robot.instance))
        return {
            body.name(): robot.plant.EvalBodyPoseInWorld(robot.plant_context, body)
            for body in bodies
        }

    before, after = poses(pose), poses(mirrored)
    assert len(before) == 29
    for link, X_WL in before.items():
        image = after[_other_side(link)]
        p_WL, R_WL = X_WL.translation(), X_WL.rotation().matrix()
        np.testing.assert_allclose(image.translation(), REFLECTION @ p_WL, atol=1e-12)
        np.testing.assert_allclose(
            image.rotation().matrix(), REFLECTION @ R_WL @ REFLECTION, atol=1e-12
        )


def test_limbs_mirror_each_other_in_limits_and_inertia(robot):
    plant, context = robot.plant, robot.plant.CreateDefaultContext()
    for name in (name for name in JOINT_ORDER if name.startswith("l_")):
        left, right = (plant.GetJointByName(n) for n in (name, _other_side(name)))
        ends = (left.position_lower_limit(), left.position_upper_limit())
        image = sorted(_mirror_sign(name) * end for end in ends)
        assert right.position_lower_limit() == image[0], name
        assert right.position_upper_limit() == image[1], name

        bodies = (left.child_body(), right.child_body())
        M_left, M_right = (b.CalcSpatialInertiaInBodyFrame(context) for b in bodies)
        assert M_left.get_mass() == M_right.get_mass()
        np.testing.assert_array_equal(M_right.get_com(), REFLECTION @ M_left.get_com())
        np.testing.assert_allclose(
            M_right.CalcRotationalInertia().CopyToFullMatrix3(),
            REFLECTION
            @ M_left.CalcRotationalInertia().CopyToFullMatrix3()
            @ REFLECTION,
            atol=1e-15,
        )


def test_few_pairs_of_shapes_can_collide(robot):
    candidates = robot.scene_graph.model_inspector().GetCollisionCandidates()
    assert 0 < len(candidates) <= MOST_COLLISION_CANDIDATES


def test_no_self_collision_between_zero_and_stand_prep_pose(robot, stand_prep):
    for share in np.linspace(0.0, 1.0, 21):
        robot.set_pose(share * stand_prep, RigidTransform())
        assert robot.colliding() == [], f"at {share:.2f} of the way"


def test_no_self_collision_within_reach_of_a_walk(robot, stand_prep):
    # How far joints stray from the stand-prep pose in a walk [rad].
    reach = dict.fromkeys(JOINT_ORDER, 0.15)
    reach |= {f"{side}_leg_hpx": 0.05 for side in "lr"}
    reach |= {f"{side}_leg_hpz": 0.05 for side in "lr"}
    reach |= {f"{side}_leg_hpy": 0.60 for side in "lr"}
    reach |= {f"{side}_leg_kny": 0.50 for side in "lr"}
    reach |= {f"{side}_leg_aky": 0.50 for side in "lr"}
    spans = np.array([reach[name] for name in JOINT_ORDER])
    generator = np.random.default_rng(1)
    for _ in range(200):
        pose = stand_prep + generator.uniform(-spans, spans)
        robot.set_pose(pose, RigidTransform())
        assert robot.colliding() == []


def test_legs_collide_when_crossed(robot, stand_prep):
    pose = stand_prep.copy()
    pose[JOINT_ORDER.index("l_leg_hpx")] = -0.3
    pose[JOINT_ORDER.index("r_leg_hpx")] = 0.3
    robot.set_pose(pose, RigidTransform())
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
    robot.set_pose(pose, RigidTransform())
    assert pair in robot.colliding()
