"""Orientation from increments of rotation: exact, and corrected to the vertical."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pydrake.common.eigen_geometry import AngleAxis, Quaternion
from pydrake.math import RollPitchYaw, RotationMatrix

from atlas_drake.control.attitude import (
    turn_between,
    turned,
    turned_in_world,
    upright_correction,
)
from atlas_drake.rotations import rotation_matrix
from atlas_drake.units import GRAVITY

component = st.floats(-3.0, 3.0, allow_subnormal=False)
vector = st.tuples(component, component, component).map(np.array)


def quaternion(roll, pitch, yaw):
    return RollPitchYaw(roll, pitch, yaw).ToQuaternion().wxyz()


@given(vector)
def test_the_matrix_is_that_of_drake(rpy):
    q = quaternion(*rpy)
    expected = RotationMatrix(Quaternion(wxyz=q)).matrix()
    np.testing.assert_allclose(rotation_matrix(q), expected, atol=1e-14)


@given(vector, vector)
def test_a_turn_is_the_rotation_about_its_axis(rpy, turn):
    q, angle = quaternion(*rpy), float(np.linalg.norm(turn))
    about = np.eye(3)
    if angle > 0.0:
        about = AngleAxis(angle=angle, axis=turn / angle).rotation()
    R = rotation_matrix(q)
    np.testing.assert_allclose(rotation_matrix(turned(q, turn)), R @ about, atol=1e-13)
    np.testing.assert_allclose(
        rotation_matrix(turned_in_world(q, turn)), about @ R, atol=1e-13
    )


@given(vector, st.tuples(*[st.floats(-1.8, 1.8)] * 3).map(np.array))
def test_the_turn_between_two_orientations_leads_from_one_to_the_other(rpy, turn):
    # Shorter than half a revolution, beyond which another way is shorter.
    q = quaternion(*rpy)
    np.testing.assert_allclose(turn_between(q, turned(q, turn)), turn, atol=1e-12)
    np.testing.assert_allclose(turn_between(q, -turned(q, turn)), turn, atol=1e-12)


def settle(q, force_W_of, seconds, settling, dt=0.01):
    """Corrects for a while; ``force_W_of(t)`` is the true specific force."""
    for k in range(round(seconds / dt)):
        # The robot is upright: what it feels is in W's axes.
        felt = rotation_matrix(q) @ force_W_of(k * dt)
        q = turned_in_world(q, upright_correction(felt, dt, settling))
    return q


def test_setting_off_tilts_by_no_more_than_the_speed_allows():
    # From rest to 0.5 m/s within half a second, then on.
    def force(t):
        return np.array([1.0 if t < 0.5 else 0.0, 0.0, GRAVITY])

    q = np.array([1.0, 0.0, 0.0, 0.0])
    for seconds in (0.2, 0.5, 2.0):
        after = settle(q, force, seconds, settling=100.0)
        tilt = np.linalg.norm(turn_between(q, after))
        assert tilt <= 0.5 / (GRAVITY * 100.0) * 1.001
