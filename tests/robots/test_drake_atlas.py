"""Drake's own Atlas: another build, whose files are not here."""

import numpy as np
import pytest
from pydrake.geometry import Mesh

from atlas_drake import (
    AtlasCommand,
    AtlasSimulation,
    Behavior,
    Scenario,
    steps_ahead,
)
from atlas_drake.clients.view.colors import painted
from atlas_drake.errors import InvalidMessageError
from atlas_drake.robot import load_robot
from atlas_drake.simulation.tutorial import tutorial_schedule


@pytest.fixture(scope="module")
def robot(load_or_skip):
    return load_or_skip("drake_atlas")


@pytest.fixture
def sim(robot):
    return AtlasSimulation(Scenario(model=robot.name))


def test_drakes_atlas_has_thirty_joints(robot):
    assert robot.num_joints == 30
    assert robot.mass == pytest.approx(175.118, abs=1e-3)
    assert robot.joints.neck_ry == robot.joints.neck_ay == 3
    # What comes before the arms is where it always was; each arm has a seventh joint.
    tutorials = load_robot()
    assert robot.joints.r_leg_akx == tutorials.joints.r_leg_akx == 15
    arm = [robot.joint_names[k] for k in np.flatnonzero(robot.limb("l_arm"))]
    assert [name[-3:] for name in arm] == [
        "shz",
        "shx",
        "ely",
        "elx",
        "uwy",
        "mwx",
        "lwy",
    ]
    leg = robot.legs[0]
    assert leg.planar.lateral_offset == pytest.approx(0.0225)
    assert (leg.thigh, leg.shank) == (tutorials.legs[0].thigh, tutorials.legs[0].shank)


def test_the_sole_spans_the_contact_points(robot):
    text = robot.urdf.read_text()
    frame = robot.plant.GetFrameByName("l_foot_sole")
    x, y, z = frame.GetFixedPoseInBodyFrame().translation()
    half_length, half_width = 0.5 * robot.file.sole.length, 0.5 * robot.file.sole.width
    for corner_x in (x - half_length, x + half_length):
        for corner_y in (y - half_width, y + half_width):
            assert f'"{corner_x:.4f} {corner_y:.4g} {z:.5f}"' in text


def test_fixed_bodies_belong_to_their_link(robot):
    plant = robot.plant
    hands = robot.hand_bodies(plant)
    for side, palm in enumerate(("left_palm", "right_palm")):
        assert hands[int(plant.GetBodyByName(palm).index())] == side
    head = robot.moved_links[robot.joints.neck_ay]
    assert {"head", "hokuyo_link"} <= set(head)


def test_the_meshes_can_be_colored(robot):
    file = robot.urdf.parent / "meshes" / "r_hand.gltf"
    mesh = painted(file, (0.9, 0.5, 0.1))
    assert [*mesh.source().in_memory().supporting_files] == ["r_hand.bin"]
    own = Mesh(str(file)).GetConvexHull()
    assert mesh.GetConvexHull().num_vertices() == own.num_vertices()


def test_the_tutorial_knows_its_joints(robot):
    *_, home = tutorial_schedule(robot)
    kp = home.command.kp_position
    assert kp[robot.joints.back_bky] == 4000.0
    assert kp[robot.joints.neck_ay] == 20.0
    assert kp[robot.joints.l_arm_mwx] == 100.0
    # Its own where the tutorial's robot has no such joint.
    assert kp[robot.joints.l_arm_shz] == robot.default_kp[robot.joints.l_arm_shz]


def test_drakes_atlas_stands_and_takes_messages_of_thirty_joints(sim):
    sim.advance(0.3)
    assert len(sim.atlas_state.position) == 30
    assert sim.pelvis_pose.translation()[2] == pytest.approx(0.90, abs=0.01)
    summary = sim.summary()
    assert summary["success"]
    assert max(summary["peak_effort_fraction"].values()) < 0.4
    with pytest.raises(InvalidMessageError, match=r"must have 30 elements, .* 28"):
        sim.publish(AtlasCommand(k_effort=[0] * 28))
    elbow = sim.robot.joints.l_arm_elx
    arms = AtlasCommand(k_effort=[0] * 30)
    arms.k_effort[elbow] = 255
    sim.publish(arms)
    sim.advance(0.02)
    assert sim.atlas_sim_interface_state.k_effort[elbow] == 255


@pytest.mark.slow
def test_drakes_atlas_walks(sim, walk):
    sim.advance(0.3)
    gait = sim.scenario.controller_config().gait(stride=0.25)
    footsteps = walk(sim, steps_ahead(sim.atlas_sim_interface_state, 0.75, gait))
    assert sim.current_behavior is Behavior.STAND
    assert len(footsteps) == 5
    assert max(step["error_m"] for step in footsteps) < 0.005
    assert sim.summary()["success"]
