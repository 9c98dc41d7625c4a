"""The inertia that the joint law assumes, and the whole robot under that law."""

import numpy as np
import pytest

from atlas_drake.control.joint_inertia import lower_joint_inertia
from atlas_drake.control.joint_pid import PidInput, PidState, user_effort

RANDOM_POSES = 150
STEPS = 2**15
"""Looked ahead for slow growth."""

PHYSICS_STEPS = (0.0005, 0.001, 0.002)
"""Those that the project offers [s]."""


@pytest.fixture(scope="module")
def lower(robot):
    return lower_joint_inertia(robot)


@pytest.fixture(scope="module")
def joint_space(model):
    """Makes the joints' inverse inertia at a pose, shape (n, n), message order.

    All joints and the pelvis are free, but for the soles that are on the ground.
    """
    robot, plant = model.robot, model.plant
    context = model.create_context()

    def inverse(pose, feet_on_the_ground=()):
        state = np.zeros(model.num_states)
        state[0] = 1.0
        state[robot.indices(plant).q] = pose
        terms = model.evaluate(context, state)
        free = np.linalg.inv(terms.M)
        if feet_on_the_ground:
            J = np.vstack([terms.feet[foot].J_WF for foot in feet_on_the_ground])
            free = free - free @ J.T @ np.linalg.inv(J @ free @ J.T) @ J @ free
        return free[6:, 6:]

    return inverse


def test_no_pose_has_less_inertia(robot, lower, joint_space):
    random = np.random.default_rng(1234)
    assert (lower > 0.0).all()
    span = robot.position_upper - robot.position_lower
    scale = np.sqrt(lower)
    for number in range(RANDOM_POSES):
        share = random.uniform(size=robot.num_joints)
        if number % 2:
            share = np.round(share)  # Corners of the joints' range.
        inverse = joint_space(robot.position_lower + share * span)
        # D ≤ M exactly when no eigenvalue of D^½ M⁻¹ D^½ exceeds 1.
        largest = np.linalg.eigvalsh(inverse * np.outer(scale, scale))[-1]
        assert largest <= 1.0


def test_the_difference_to_the_true_inertia_is_not_negative(robot, lower, joint_space):
    # The same in the words of the docstring: M - D has no negative eigenvalue.
    random = np.random.default_rng(77)
    for _ in range(10):
        pose = random.uniform(robot.position_lower, robot.position_upper)
        M = np.linalg.inv(joint_space(pose))
        assert np.linalg.eigvalsh(M - np.diag(lower))[0] >= 0.0


def test_it_is_the_same_every_time(robot, lower):
    assert lower_joint_inertia(robot).tobytes() == lower.tobytes()


def step_matrix(kp, kd, assumed, inverse, dt):
    """One step of the robot's joints under the law, linear in [q; v; v_last; τ_last].

    Column by column from the law itself, with inertia at a pose frozen.
    """
    n = len(kp)
    q, v, last_v, last_effort = np.split(np.eye(4 * n), 4)
    zero, column = np.zeros((n, 1)), np.s_[:, None]
    command = PidInput(
        position=zero,
        velocity=zero,
        effort=zero,
        kp_position=kp[column],
        ki_position=zero,
        kd_position=kd[column],
        kp_velocity=zero,
        i_effort_min=zero,
        i_effort_max=zero,
    )
    effort = user_effort(
        PidState(zero, last_v, last_effort),
        command,
        zero,
        q,
        v,
        np.ones((n, 1)),
        assumed[column],
        np.full((n, 1), np.inf),
        dt,
    )
    next_v = v + dt * inverse @ effort
    return np.vstack([q + dt * next_v, next_v, v, effort])


@pytest.mark.parametrize("feet", [(), (0,), (0, 1)], ids=["air", "left", "both"])
@pytest.mark.parametrize("dt", PHYSICS_STEPS)
@pytest.mark.parametrize("extra_damping", [0.0, 50.0])
def test_the_whole_robot_is_stable_under_the_law(
    robot, lower, joint_space, feet, dt, extra_damping
):
    random = np.random.default_rng(8)
    poses = [
        robot.stand_prep,
        random.uniform(robot.position_lower, robot.position_upper),
    ]
    for pose in poses:
        step = step_matrix(
            robot.default_kp,
            robot.default_kd + extra_damping,
            lower,
            joint_space(pose, feet),
            dt,
        )
        # A motion that the ground prevents, but the linear step allows, drifts in
        # proportion to time; one that grows by e.g. 0.01% a step would double often.
        half = np.linalg.matrix_power(step, STEPS // 2)
        assert np.abs(half @ half).max() <= 3.0 * np.abs(half).max()
