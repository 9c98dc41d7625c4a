"""Vectors and quaternions to arrays and back."""

import numpy as np
import pytest

from atlas_drake.messages import Pose, Quaternion, Vector3


def test_vector_to_array_and_back():
    vector = Vector3.from_array([1, 2, 3])
    assert (vector.x, vector.y, vector.z) == (1.0, 2.0, 3.0)
    np.testing.assert_array_equal(vector.to_array(), [1.0, 2.0, 3.0])


def test_quaternion_puts_the_scalar_first_in_arrays_only():
    quaternion = Quaternion.from_wxyz(np.array([0.5, 0.1, 0.2, 0.3]))
    assert quaternion == Quaternion(x=0.1, y=0.2, z=0.3, w=0.5)
    np.testing.assert_array_equal(quaternion.to_wxyz(), [0.5, 0.1, 0.2, 0.3])


def test_arrays_of_another_length_are_refused():
    with pytest.raises(ValueError, match="unpack"):
        Vector3.from_array([1.0, 2.0])
    with pytest.raises(ValueError, match="unpack"):
        Quaternion.from_wxyz([1.0, 0.0, 0.0])


def test_an_empty_pose_is_the_identity():
    np.testing.assert_array_equal(Pose().orientation.to_wxyz(), [1.0, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(Pose().position.to_array(), np.zeros(3))
