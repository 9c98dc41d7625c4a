"""PyKDL, posemath and tf.transformations, beside Drake."""

import numpy as np
import pytest
from pydrake.math import RigidTransform, RollPitchYaw

from atlas_drake.ros_scripts import transformations as tf
from atlas_drake.ros_scripts.kdl_frame import Frame, Twist, diff
from atlas_drake.ros_scripts.kdl_rotation import Rotation
from atlas_drake.ros_scripts.kdl_vector import Vector, dot
from atlas_drake.ros_scripts.message_types import geometry_msgs
from atlas_drake.ros_scripts.unknown import ScriptError

RPY = (0.3, -0.4, 1.1)
X = RigidTransform(RollPitchYaw(*RPY), [1.0, 2.0, 3.0])


def test_frames_multiply_as_poses_do():
    frame = Frame(Rotation.RPY(*RPY), Vector(1.0, 2.0, 3.0))
    other = Frame(Rotation.RotZ(0.5), Vector(0.1, 0.2, 0.3))
    Y = RigidTransform(RollPitchYaw(0, 0, 0.5), [0.1, 0.2, 0.3])
    assert (frame * other).transform().IsNearlyEqualTo(X @ Y, 1e-12)
    assert (
        (frame * frame.Inverse())
        .transform()
        .IsNearlyEqualTo(Frame().transform(), 1e-12)
    )
    np.testing.assert_allclose([*(frame * Vector(1, 0, 0))], X @ [1.0, 0, 0])
    assert frame.M.GetRPY() == pytest.approx(RPY)
    assert frame.M.GetEulerZYX() == pytest.approx(RPY[::-1])
    assert frame[0, 3] == 1.0
    assert Frame(frame) == frame


def test_frames_become_messages_and_back():
    pose = tf.to_msg(Frame.of(X))
    assert pose._type == "geometry_msgs/Pose"
    assert tf.from_msg(pose).transform().IsNearlyEqualTo(X, 1e-12)
    assert tf.from_tf(tf.to_tf(Frame.of(X))).transform().IsNearlyEqualTo(X, 1e-12)
    np.testing.assert_allclose(tf.to_matrix(Frame.of(X)), X.GetAsMatrix4())
    assert tf.from_matrix(X.GetAsMatrix4()).transform().IsNearlyEqualTo(X, 1e-12)


def test_a_pose_left_as_it_was_made_is_no_rotation():
    assert tf.from_msg(geometry_msgs["Pose"]()) == Frame()


def test_vectors():
    v = Vector(3.0, 0.0, 4.0)
    assert (v.Norm(), dot(v, Vector(1, 1, 1)), (2 * v).x()) == (5.0, 7.0, 6.0)
    assert v * Vector(0, 1, 0) == Vector(-4.0, 0.0, 3.0)  # The cross product.
    assert v / 2 - v == -v / 2
    v.z(0.0)
    assert [*v] == [3.0, 0.0, 0.0]
    assert v.Normalize() == 3.0
    with pytest.raises(TypeError, match="3 numbers"):
        Vector(1.0, 2.0)


def test_twists_lead_from_one_frame_to_another():
    twist = diff(Frame(), Frame(Rotation.RotZ(0.2), Vector(1, 0, 0)), 2.0)
    np.testing.assert_allclose([twist[i] for i in range(6)], [0.5, 0, 0, 0, 0, 0.1])
    turned = Rotation.RotZ(np.pi / 2) * Twist(Vector(1, 0, 0))
    np.testing.assert_allclose([*turned.vel], [0, 1, 0], atol=1e-12)


def test_transformations():
    q = tf.quaternion_from_euler(*RPY)
    np.testing.assert_allclose(
        q, np.roll(X.rotation().ToQuaternion().wxyz(), -1), atol=1e-12
    )
    assert tf.euler_from_quaternion(q) == pytest.approx(RPY)
    back = tf.quaternion_multiply(q, tf.quaternion_inverse(q))
    np.testing.assert_allclose(np.abs(back), [0, 0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(
        tf.quaternion_from_matrix(tf.quaternion_matrix(q)), q, atol=1e-12
    )
    assert tf.euler_from_matrix(tf.euler_matrix(*RPY)) == pytest.approx(RPY)
    with pytest.raises(ScriptError, match="rzyx"):
        tf.euler_from_quaternion(q, "rzyx")
