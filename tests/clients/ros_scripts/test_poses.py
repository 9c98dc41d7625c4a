"""PyKDL, posemath and tf.transformations, beside Drake."""

import numpy as np
import pytest
from pydrake.math import RigidTransform, RollPitchYaw

from atlas_drake.clients.ros_scripts import poses
from atlas_drake.clients.ros_scripts.poses import Frame, Rotation, Vector
from atlas_drake.clients.ros_scripts.ros_types import geometry_msgs

RPY = (0.3, -0.4, 1.1)
X = RigidTransform(RollPitchYaw(*RPY), [1.0, 2.0, 3.0])
FRAME = Frame(Rotation.RPY(*RPY), Vector(1.0, 2.0, 3.0))


def transform(frame):
    return RigidTransform(frame.M.R, frame.p)


def test_frames_multiply_as_poses_do():
    other = Frame(Rotation.RPY(0.0, 0.0, 0.5), Vector(0.1, 0.2, 0.3))
    Y = RigidTransform(RollPitchYaw(0, 0, 0.5), [0.1, 0.2, 0.3])
    assert transform(FRAME * other).IsNearlyEqualTo(X @ Y, 1e-12)
    assert transform(FRAME.Inverse()).IsNearlyEqualTo(X.inverse(), 1e-12)
    np.testing.assert_allclose(FRAME * Vector(1, 0, 0), X @ [1.0, 0, 0])
    assert FRAME.M.GetRPY() == pytest.approx(RPY)


def test_frames_become_messages_and_back():
    pose = poses.to_msg(FRAME)
    assert pose._type == "geometry_msgs/Pose"
    assert transform(poses.from_msg(pose)).IsNearlyEqualTo(X, 1e-12)
    # A pose whose fields were not set is the identity.
    unset = poses.from_msg(geometry_msgs["Pose"]())
    assert transform(unset).IsExactlyIdentity()


def test_vectors_add_and_scale():
    v = Vector(3.0, 0.0, 4.0)
    assert (v.x(), v.y(), v.z()) == (3.0, 0.0, 4.0)
    assert list(v / 2 - v) == list(-v * 0.5) == [-1.5, 0.0, -2.0]
    assert isinstance(2 * v + v, Vector)
    v[2] = 0.0
    assert list(v) == [3.0, 0.0, 0.0]


def test_quaternions_agree_with_drake():
    q = poses.quaternion_from_euler(*RPY)
    wxyz = X.rotation().ToQuaternion().wxyz()
    np.testing.assert_allclose(q, np.roll(wxyz, -1), atol=1e-12)
    assert poses.euler_from_quaternion(q) == pytest.approx(RPY)
