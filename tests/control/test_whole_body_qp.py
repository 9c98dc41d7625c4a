"""The whole-body QP: physics hold exactly, bounds are kept, tasks are met."""

import dataclasses

import numpy as np
import pytest

from atlas_drake.control.feet.sole import sole_patches
from atlas_drake.control.gains import ContactModel, ControlGains, QpWeights
from atlas_drake.control.whole_body import (
    ComTask,
    Contact,
    EffortBounds,
    FrameTask,
    InternalContactTask,
    MomentTask,
    OrientationTask,
    PostureTask,
    WholeBodyCommand,
    WholeBodyQp,
)
from atlas_drake.units import GRAVITY

from .conftest import residual

FEET = {"both": (0, 1), "left": (0,), "right": (1,), "none": ()}
TOLERANCE = 1e-5
"""To which the solver keeps bounds and equalities [N·m]."""

UNBOUNDED = 1e5
"""Normal force that no foot here reaches [N]."""


@pytest.fixture(scope="module")
def gains():
    return ControlGains()


@pytest.fixture(scope="module")
def qp(robot, gains):
    return WholeBodyQp(robot, gains)


@pytest.fixture
def bounds(robot):
    """All joints the behavior's own."""
    limit = robot.effort_limit
    return EffortBounds(-limit, limit, np.zeros(robot.num_joints, dtype=bool))


WEIGHTS = QpWeights()


def command_for(robot, contacts, random=None, scale=1.0, weights=WEIGHTS):
    """A command with the given feet in contact: to rest, or at random.

    Without a contact there is nothing to balance with, and the trunk is left alone.
    """

    def wish(size):
        return np.zeros(size) if random is None else scale * random.normal(size=size)

    frames = [foot.sole_frame for foot in robot.file.feet]
    com, point, pelvis, chest = wish(3), 0.1 * wish(3), wish(3), wish(3)
    swing = [weights.swing_foot_orientation] * 3 + [weights.swing_foot_position] * 3
    tasks = [
        FrameTask(
            frame, wish(6), weights.stance_foot if foot in contacts else np.array(swing)
        )
        for foot, frame in enumerate(frames)
    ]
    if contacts:
        force = weights.internal_contact_force
        tasks += [
            OrientationTask(robot.file.chest, chest, weights.chest_tilt),
            OrientationTask(robot.file.pelvis, pelvis, weights.pelvis_tilt),
            MomentTask(point, weights.moment),
            ComTask(com, np.array([weights.com, weights.com, weights.com_height])),
            InternalContactTask(
                tuple(frames), np.array([weights.internal_contact_moment, force, force])
            ),
        ]
    patch = sole_patches(robot.file.sole, ContactModel()).whole
    return WholeBodyCommand(
        posture=PostureTask(wish(robot.num_joints), np.full(robot.num_joints, 0.05)),
        tasks=tuple(tasks),
        contacts=tuple(Contact(frames[foot], patch, UNBOUNDED) for foot in contacts),
    )


def with_target(command, kind, **changes):
    """The command with its task of this kind changed."""
    tasks = [
        dataclasses.replace(task, **changes) if isinstance(task, kind) else task
        for task in command.tasks
    ]
    return dataclasses.replace(command, tasks=tuple(tasks))


def with_left_contact(command, **changes):
    """The command with its first contact changed."""
    first, *others = command.contacts
    first = dataclasses.replace(first, **changes)
    return dataclasses.replace(command, contacts=(first, *others))


def wrenches_on(robot, solution):
    """Wrenches on left and right sole, shape (2, 6); zero for a foot in the air."""
    found = solution.contact_wrenches
    names = [foot.sole_frame for foot in robot.file.feet]
    return np.array([found.get(name, np.zeros(6)) for name in names])


def point_below(terms, acceleration=(0.0, 0.0, 0.0)):
    """Point at the height of the soles about which the acceleration has no moment."""
    acceleration = np.array(acceleration)
    point = np.array([*terms.com[:2], terms.feet[0].p_WF[2]])
    point[:2] -= acceleration[:2] * (terms.com[2] - point[2]) / GRAVITY
    return point


def over_its_feet(command, terms, acceleration=(0.0, 0.0, 0.0)):
    """The command with the forces' sum through the point for the acceleration."""
    point = point_below(terms, acceleration)
    command = with_target(command, ComTask, target=np.array(acceleration))
    return with_target(command, MomentTask, p_WE=point)


def moving(model, random_state, standing, seed):
    """Terms near the stand-prep pose, so that contacts make sense, but in motion."""
    random = np.random.default_rng(seed)
    state = random_state(seed)
    indices = model.robot.indices(model.plant)
    state[:4] = np.array([1.0, 0.0, 0.0, 0.0]) + 0.02 * random.normal(size=4)
    state[:4] /= np.linalg.norm(state[:4])
    state[indices.q] = standing.q + 0.05 * random.normal(size=len(standing.q))
    state[model.plant.num_positions() :] *= 0.1
    return model.evaluate(model.create_context(), state)


@pytest.mark.parametrize("feet", FEET)
@pytest.mark.parametrize("seed", range(3))
def test_solution_obeys_the_equations_of_motion(
    model, robot, qp, bounds, random_state, standing, feet, seed
):
    terms = moving(model, random_state, standing, seed)
    random = np.random.default_rng(seed)
    solution = qp.solve(terms, command_for(robot, FEET[feet], random), bounds)
    assert solution.found
    np.testing.assert_allclose(residual(terms, solution), 0.0, atol=1e-6)
    assert (np.abs(solution.effort) <= robot.effort_limit + TOLERANCE).all()


@pytest.mark.parametrize("feet", ["both", "left", "right"])
def test_wrenches_are_ones_that_the_ground_can_give(
    model, robot, qp, gains, bounds, random_state, standing, feet
):
    contact, sole = gains.contact, robot.file.sole
    # Center of pressure: p = (-m_y, m_x) / normal.
    reach_x = sole.length / 2 - contact.length_margin
    reach_y = sole.width / 2 - contact.width_margin
    yaw = contact.friction * contact.yaw_moment_arm
    limits_met = 0
    for seed in range(10):
        terms = moving(model, random_state, standing, seed)
        # Wishes far beyond what friction and the soles' edges allow.
        random = np.random.default_rng(seed)
        command = command_for(robot, FEET[feet], random, scale=30.0)
        solution = qp.solve(terms, command, bounds)
        assert solution.found
        for foot in FEET[feet]:
            R_FW = terms.feet[foot].R_WF.T
            moment = R_FW @ wrenches_on(robot, solution)[foot, :3]
            force = R_FW @ wrenches_on(robot, solution)[foot, 3:]
            normal, slack = force[2], 1e-5
            assert normal >= -slack
            # The true friction cone; the program keeps to a pyramid inside it.
            assert np.hypot(force[0], force[1]) <= contact.friction * normal + slack
            assert abs(moment[1]) <= reach_x * normal + slack
            assert abs(moment[0]) <= reach_y * normal + slack
            assert abs(moment[2]) <= yaw * normal + slack
            # About the center of pressure: friction at the farthest corner at most.
            x, y = np.array([-moment[1], moment[0]]) / max(normal, slack)
            torsion = moment[2] - (x * force[1] - y * force[0])
            farthest = np.hypot(abs(x) + reach_x, abs(y) + reach_y)
            assert abs(torsion) <= contact.friction * farthest * normal + slack
            limits_met += abs(moment[1]) > 0.999 * reach_x * normal > slack
            limits_met += abs(moment[0]) > 0.999 * reach_y * normal > slack
    assert limits_met >= 3, "wishes too small to test the limits"


@pytest.mark.parametrize("ahead", [0.0, 0.05])
def test_center_of_pressure_is_where_it_shall_be(robot, qp, bounds, standing, ahead):
    height = standing.com[2] - standing.feet[0].p_WF[2]
    acceleration = [-ahead * GRAVITY / height, 0.0, 0.0]
    command = over_its_feet(command_for(robot, (0, 1)), standing, acceleration)
    solution = qp.solve(standing, command, bounds)
    moment = np.zeros(3)
    for foot, wrench in zip(standing.feet, wrenches_on(robot, solution), strict=True):
        moment += wrench[:3] + np.cross(foot.p_WF, wrench[3:])
    force = wrenches_on(robot, solution)[:, 5].sum()
    cop = np.array([-moment[1], moment[0]]) / force
    np.testing.assert_allclose(cop, point_below(standing, acceleration)[:2], atol=0.01)


@pytest.mark.parametrize("feet", FEET)
def test_user_held_joints_get_exactly_the_users_effort(
    robot, qp, bounds, standing, feet
):
    held = robot.limb("l_arm", "r_arm", "neck")
    effort = np.where(held, np.linspace(-5.0, 5.0, robot.num_joints), 0.0)
    mixed = EffortBounds(
        np.where(held, effort, bounds.lower), np.where(held, effort, bounds.upper), held
    )
    command = command_for(robot, FEET[feet])
    solution = qp.solve(standing, command, mixed)
    assert solution.found
    np.testing.assert_allclose(solution.effort[held], effort[held], atol=TOLERANCE)
    # Their motion is what these efforts give, and the rest of the body knows of it.
    np.testing.assert_allclose(residual(standing, solution), 0.0, atol=1e-6)
    free = qp.solve(standing, command, bounds)
    assert np.abs(solution.joint_acceleration - free.joint_acceleration)[held].max() > 1


def test_users_that_resist_acceleration_are_reckoned_with(robot, qp, bounds, standing):
    # The user's damper takes an effort of inertia·v̇ off what the bounds say.
    held = robot.limb("l_arm", "r_arm", "neck")
    effort = np.where(held, np.linspace(-5.0, 5.0, robot.num_joints), 0.0)
    inertia = np.where(held, 0.3, 0.0)
    mixed = EffortBounds(
        np.where(held, effort, bounds.lower),
        np.where(held, effort, bounds.upper),
        held,
        inertia,
    )
    solution = qp.solve(standing, command_for(robot, (0, 1)), mixed)
    assert solution.found
    np.testing.assert_allclose(residual(standing, solution), 0.0, atol=1e-6)
    resisted = effort - inertia * solution.joint_acceleration
    np.testing.assert_allclose(solution.effort[held], resisted[held], atol=TOLERANCE)
    assert np.abs(inertia * solution.joint_acceleration).max() > 0.1


def test_effort_bounds_of_blended_joints_are_kept(robot, qp, bounds, standing):
    free = qp.solve(standing, command_for(robot, (0, 1)), bounds)
    half = 0.5 * np.abs(free.effort)
    tight = EffortBounds(-half, half, bounds.user_held)
    solution = qp.solve(standing, command_for(robot, (0, 1)), tight)
    assert solution.found
    assert (np.abs(solution.effort) <= half + TOLERANCE).all()
    np.testing.assert_allclose(residual(standing, solution), 0.0, atol=1e-6)


def test_normal_force_keeps_to_its_bounds(robot, qp, bounds, standing):
    command = over_its_feet(command_for(robot, (0, 1)), standing)
    share = 0.1 * robot.mass * GRAVITY
    capped = with_left_contact(command, max_normal_force=share)
    solution = qp.solve(standing, capped, bounds)
    assert solution.found
    assert wrenches_on(robot, solution)[0, 5] <= share * (1.0 + 1e-3)
    raised = with_left_contact(command, min_normal_force=8.0 * share)
    solution = qp.solve(standing, raised, bounds)
    assert solution.found
    assert wrenches_on(robot, solution)[0, 5] >= 8.0 * share - 1e-5


@pytest.mark.parametrize("beyond", [0.05, -0.01])
def test_joints_near_or_beyond_their_limits_are_turned_back(
    model, robot, qp, bounds, standing, beyond
):
    knee = robot.joint_index("l_leg_kny")
    state = np.zeros(model.num_states)
    state[0] = 1.0
    q = standing.q.copy()
    q[knee] = robot.position_upper[knee] + beyond
    state[robot.indices(model.plant).q] = q
    terms = model.evaluate(model.create_context(), state)
    wish = np.zeros(robot.num_joints)
    wish[knee] = 50.0
    command = command_for(robot, ())
    posture = dataclasses.replace(command.posture, target=wish)
    command = dataclasses.replace(command, posture=posture)
    solution = qp.solve(terms, command, bounds)
    assert solution.found
    assert solution.joint_acceleration[knee] < 0.0


def test_without_a_solution_the_efforts_compensate_gravity(robot, qp, bounds, standing):
    impossible = with_left_contact(
        command_for(robot, (0, 1)), min_normal_force=2.0, max_normal_force=1.0
    )
    solution = qp.solve(standing, impossible, bounds)
    assert not solution.found
    weight = robot.mass * GRAVITY
    np.testing.assert_allclose(
        wrenches_on(robot, solution)[:, 5], [weight / 2, weight / 2], rtol=1e-12
    )
    expected = standing.h[6:].copy()
    for foot, wrench in zip(standing.feet, wrenches_on(robot, solution), strict=True):
        expected -= foot.J_WF[:, 6:].T @ wrench
    np.testing.assert_allclose(solution.effort, expected, atol=1e-9)
