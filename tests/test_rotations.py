"""Rotation helpers against Drake's and against their definitions."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.math import RollPitchYaw, RotationMatrix

from atlas_drake.rotations import (
    cross,
    mean_yaw,
    orientation,
    rotation_about,
    rotation_error,
    rotation_vector,
    rotation_with_normal,
    rotation_x,
    rotation_y,
    rotation_z,
    tilt_of,
    wrap_angle,
    yaw_of,
)

ANGLES = st.floats(-50.0, 50.0)
SMALL = st.floats(-3.0, 3.0)


@given(angle=ANGLES)
def test_elementary_rotations_are_drakes(angle):
    for found, expected in (
        (rotation_x(angle), RotationMatrix.MakeXRotation(angle)),
        (rotation_y(angle), RotationMatrix.MakeYRotation(angle)),
        (rotation_z(angle), RotationMatrix.MakeZRotation(angle)),
    ):
        np.testing.assert_allclose(found, expected.matrix(), atol=1e-14)


@given(yaw=SMALL, pitch=st.floats(-1.5, 1.5), roll=SMALL)
def test_orientation_is_roll_pitch_yaw_and_yaw_and_tilt_take_it_apart(yaw, pitch, roll):
    R = orientation(yaw, np.array([roll, pitch]))
    expected = RotationMatrix(RollPitchYaw(roll, pitch, yaw)).matrix()
    np.testing.assert_allclose(R, expected, atol=1e-12)
    np.testing.assert_allclose(tilt_of(R), [roll, pitch], atol=1e-7)
    assert yaw_of(R) == pytest.approx(yaw)


@given(*[st.tuples(SMALL, SMALL, SMALL).map(np.array)] * 2)
def test_the_vector_product_is_numpys(a, b):
    np.testing.assert_allclose(cross(a, b), np.cross(a, b), atol=1e-15)


@given(angle=ANGLES)
def test_wrapped_angle_is_the_same_direction_and_small(angle):
    wrapped = wrap_angle(angle)
    assert abs(wrapped) <= math.pi
    assert math.cos(wrapped - angle) == pytest.approx(1.0)


@given(yaw=ANGLES, turn=st.floats(-3.1, 3.1))
def test_mean_yaw_lies_halfway_on_the_short_way(yaw, turn):
    mean = mean_yaw(yaw, yaw + turn)
    assert wrap_angle(mean - yaw) == pytest.approx(0.5 * turn, abs=1e-9)


@given(lean=st.floats(0.0, 1.5), to=ANGLES, spin=st.floats(-1.5, 1.5), heading=ANGLES)
def test_rotation_error_turns_z_to_z_and_then_about_it(lean, to, spin, heading):
    R_WD = RollPitchYaw(0.3, -0.2, heading).ToRotationMatrix()
    about = np.array([math.cos(to), math.sin(to), 0.0])
    R_DB = RotationMatrix(AngleAxis(-lean, about)) @ RotationMatrix.MakeZRotation(-spin)
    error = rotation_error(R_WD.matrix(), (R_WD @ R_DB).matrix())
    in_D = math.sin(lean) * about + [0.0, 0.0, math.sin(spin)]
    np.testing.assert_allclose(error, R_WD.matrix() @ in_D, atol=1e-9)


@given(spin=st.floats(-3.1, 3.1))
def test_a_body_is_brought_upright_from_where_it_leans_however_it_has_spun(spin):
    leaning = RotationMatrix.MakeYRotation(0.5) @ RotationMatrix.MakeZRotation(spin)
    x, y, z = rotation_error(np.eye(3), leaning.matrix()).tolist()
    assert (x, y) == pytest.approx((0.0, -math.sin(0.5)))
    assert z * spin <= 0.0
    assert abs(z) == pytest.approx(math.sin(min(abs(spin), math.pi / 2)))


@given(yaw=ANGLES, tilt=st.floats(-0.6, 0.6), heading=ANGLES)
def test_rotation_with_normal_keeps_normal_and_heading(yaw, tilt, heading):
    normal = np.array(
        [
            math.sin(tilt) * math.cos(heading),
            math.sin(tilt) * math.sin(heading),
            math.cos(tilt),
        ]
    )
    R = rotation_with_normal(yaw, normal)
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1.0)
    np.testing.assert_allclose(R[:, 2], normal, atol=1e-15)
    # Seen from above the x axis leads exactly where it is told.
    assert abs(wrap_angle(yaw_of(R) - yaw)) < 1e-9


@pytest.mark.parametrize("vector", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.9), (0.0, 1.5, 2.0)])
def test_rotation_vector_and_rotation_about_are_each_others_inverse(vector):
    R = rotation_about(np.array(vector))
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(rotation_vector(R), vector, atol=1e-12)


def test_rotation_about_the_axes():
    np.testing.assert_allclose(rotation_about(np.array([0, 0, 0.7])), rotation_z(0.7))
    np.testing.assert_allclose(rotation_about(np.array([0, 0.7, 0])), rotation_y(0.7))
