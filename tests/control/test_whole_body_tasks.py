"""Each task alone: its rows are as documented, and the QP meets its target."""

import dataclasses
import re
from dataclasses import replace

import numpy as np
import pytest
from pydrake.solvers import ClpSolver, MathematicalProgram

from atlas_drake.control.gains import ContactModel, ControlGains, PdGains
from atlas_drake.control.whole_body import (
    ComTask,
    Contact,
    ContactPatch,
    EffortBounds,
    FrameTask,
    InternalContactTask,
    MomentTask,
    OrientationTask,
    PositionTask,
    PostureTask,
    Task,
    TaskBounds,
    TaskRows,
    WholeBodyCommand,
    WholeBodyQp,
)
from atlas_drake.robot import ContactEntry
from atlas_drake.rotations import rotation_about
from atlas_drake.units import GRAVITY

from .conftest import motion, residual

HAND = "l_hand"
GAINS = PdGains(kp=100.0, kd=20.0)
ZERO = np.zeros(3)
SIZES = {FrameTask: 6, OrientationTask: 3, PositionTask: 3}
PATCH = ContactPatch.rectangle((-0.1, 0.1), (-0.05, 0.05), 0.6, 0.05)


@pytest.fixture(scope="module")
def qp(robot):
    return WholeBodyQp(robot, ControlGains())


@pytest.fixture
def bounds(robot):
    """Motors without limits, so that only the task decides."""
    limit = np.full(robot.num_joints, 1e4)
    return EffortBounds(-limit, limit, np.zeros(robot.num_joints, dtype=bool))


@pytest.fixture
def terms(model, standing):
    """The standing robot with the joints off their limits, slowly moving."""
    state = np.zeros(model.num_states)
    state[0] = 1.0
    robot, indices = model.robot, model.robot.indices(model.plant)
    middle = 0.5 * (robot.position_lower + robot.position_upper)
    state[indices.q] = 0.8 * standing.q + 0.2 * middle
    moving = np.random.default_rng(0).normal(size=model.plant.num_velocities())
    state[model.plant.num_positions() :] = 0.05 * moving
    return model.evaluate(model.create_context(), state)


def soles(robot, most=1e5):
    return tuple(
        Contact(foot.sole_frame, PATCH, max_normal_force=most)
        for foot in robot.file.feet
    )


def still(robot, *tasks, contacts=(), constraints=()):
    """A command of these tasks over a posture at rest that hardly counts."""
    n = robot.num_joints
    posture = PostureTask(np.zeros(n), np.full(n, 1e-4))
    return WholeBodyCommand(posture, tasks, contacts, constraints)


def value(task, terms, command, solution):
    """What the solution makes of the task's rows."""
    rows = task.rows(terms, command.contacts)
    result = np.array(rows.b)
    if rows.A is not None:
        result += rows.A @ motion(terms, solution)
    if rows.G is not None:
        wrenches = solution.contact_wrenches
        stacked = [wrenches[contact.frame] for contact in command.contacts]
        result += rows.G @ np.concatenate(stacked)
    return result


@pytest.mark.parametrize("kind", SIZES)
def test_a_task_on_a_frame_meets_its_target(robot, qp, bounds, terms, kind):
    target = np.linspace(-1.0, 2.0, SIZES[kind])
    task = kind(HAND, target, 100.0)
    assert task.dimension == SIZES[kind]
    command = still(robot, task, contacts=soles(robot))
    solution = qp.solve(terms, command, bounds)
    assert solution.found
    np.testing.assert_allclose(value(task, terms, command, solution), target, atol=1e-3)
    F = terms.frame(HAND)
    acceleration = F.J_WF @ motion(terms, solution) + F.bias
    part = slice(3, 6) if kind is PositionTask else slice(SIZES[kind])
    np.testing.assert_allclose(acceleration[part], target, atol=1e-3)


def test_tasks_track_a_pose_with_their_pd_law(robot, terms):
    F = terms.frame(HAND)
    ahead, turn = np.array([0.1, -0.05, 0.02]), np.array([2e-3, -1e-3, 3e-3])
    there = PositionTask.tracking(terms, HAND, F.p_WF + ahead, GAINS, 1.0)
    expected = GAINS.kp * ahead - GAINS.kd * F.V_WF[3:]
    np.testing.assert_allclose(there.target, expected)
    R_WD = rotation_about(turn) @ F.R_WF
    task = OrientationTask.tracking(terms, HAND, R_WD, GAINS, 1.0, w_WD=F.V_WF[:3])
    np.testing.assert_allclose(task.target, GAINS.kp * turn, atol=1e-3)


def test_the_com_task_is_the_acceleration_of_the_center_of_mass(
    robot, qp, bounds, terms
):
    target = np.array([0.3, -0.2, 0.5])
    command = still(robot, ComTask(target, 100.0), contacts=soles(robot))
    solution = qp.solve(terms, command, bounds)
    assert solution.found
    # Momentum by the mass matrix, which the task's own rows do not use.
    force = terms.M[3:6] @ motion(terms, solution) + terms.h[3:6]
    gravity = np.array([0.0, 0.0, -GRAVITY])
    np.testing.assert_allclose(force / terms.mass + gravity, target, atol=1e-2)


def test_the_moment_task_directs_the_sum_of_the_forces(robot, qp, bounds, terms):
    point = terms.com - np.array([0.03, -0.02, 0.8])
    lift = ComTask(np.zeros(3), np.array([0.0, 0.0, 100.0]))
    target = np.array([0.2, -0.1])
    task = MomentTask(point, 100.0, target)
    command = still(robot, lift, task, contacts=soles(robot))
    solution = qp.solve(terms, command, bounds)
    assert solution.found
    moment = np.zeros(3)
    for name, wrench in solution.contact_wrenches.items():
        moment += wrench[:3] + np.cross(terms.frame(name).p_WF - point, wrench[3:])
    found = moment[[1, 0]] / (terms.mass * 0.8)
    np.testing.assert_allclose(found, target, atol=1e-2)


def test_internal_contact_forces_and_moments_meet_their_target(
    robot, qp, bounds, terms
):
    frames = tuple(foot.sole_frame for foot in robot.file.feet)
    target = np.array([2.0, 10.0, -5.0])
    task = InternalContactTask(frames, np.full(3, 1.0), target)
    lift = ComTask(np.zeros(3), 100.0)
    solution = qp.solve(terms, still(robot, lift, task, contacts=soles(robot)), bounds)
    left, right = (solution.contact_wrenches[name] for name in frames)
    np.testing.assert_allclose((left - right)[[2, 3, 4]], target, rtol=0.01)
    alone = InternalContactTask(frames, np.ones(3)).rows(terms, soles(robot)[:1])
    np.testing.assert_array_equal(alone.G, np.zeros((3, 6)))


@dataclasses.dataclass(frozen=True)
class SumTask(Task):
    """A user's own: rows on accelerations and wrenches at once."""

    target: np.ndarray
    weight: float

    def rows(self, terms, contacts):
        A = np.zeros((1, len(terms.M)))
        A[0, 6] = 1.0
        G = np.zeros((1, 6 * len(contacts)))
        G[0, 5] = 0.01
        return TaskRows(A, np.array([0.25]), G)


def test_a_task_of_ones_own_may_mix_accelerations_and_wrenches(
    robot, qp, bounds, terms
):
    task = SumTask(np.array([3.0]), 100.0)
    before, after = FrameTask(HAND, np.ones(6), 1.0), ComTask(np.zeros(3), 1.0)
    command = still(robot, after, before, task, contacts=soles(robot))
    solution = qp.solve(terms, command, bounds)
    assert solution.found
    np.testing.assert_allclose(value(task, terms, command, solution), 3.0, atol=1e-2)


@pytest.mark.parametrize("soft", [True, False])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_bound_on_a_task_is_kept(robot, qp, bounds, terms, soft, sign):
    wish = PositionTask(HAND, np.array([2.0 * sign, 0.0, 0.0]), 100.0)
    most = np.array([0.5, 5.0, 5.0])
    limit = TaskBounds(wish, -most, most, soft)
    command = still(robot, wish, contacts=soles(robot))
    free = value(wish, terms, command, qp.solve(terms, command, bounds))
    kept = qp.solve(terms, command.plus(constraints=[limit]), bounds)
    assert kept.found
    assert sign * free[0] > 1.9
    assert value(wish, terms, command, kept)[0] == pytest.approx(0.5 * sign, abs=1e-3)


# ---- contacts ----------------------------------------------------------------


def test_a_hand_on_a_rail_carries_load(robot, qp, bounds, terms):
    """With one foot allowed little, the hand takes what the foot cannot."""
    hand = terms.frame(HAND)
    palm = ContactPatch(
        corners=0.02 * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]),
        friction=0.6,
        yaw_moment_arm=0.02,
        # The rail pushes straight up, however the hand is turned.
        R_FC=hand.R_WF.T,
        p_FC=np.array([0.0, 0.05, 0.0]),
    )
    most = 0.4 * robot.mass * GRAVITY
    rail = Contact(HAND, palm, max_normal_force=most, support_share=0.0)
    still_hand = FrameTask(HAND, np.zeros(6), 50.0)
    feet = soles(robot, most)
    tasks = (ComTask(np.zeros(3), 100.0), still_hand)
    lacking = qp.solve(terms, still(robot, *tasks, contacts=feet), bounds)
    held = qp.solve(terms, still(robot, *tasks, contacts=(*feet, rail)), bounds)
    assert lacking.found
    assert held.found
    assert list(held.contact_wrenches) == [*lacking.contact_wrenches, HAND]
    np.testing.assert_allclose(residual(terms, held), 0.0, atol=1e-6)
    wrench = held.contact_wrenches[HAND]
    force = wrench[3:]
    assert force[2] > 0.15 * robot.mass * GRAVITY
    total = sum(wrench[5] for wrench in held.contact_wrenches.values())
    assert total == pytest.approx(robot.mass * GRAVITY, rel=0.01)
    # Within friction, and with the pressure under the palm.
    assert np.hypot(force[0], force[1]) <= 0.6 * force[2] + 1e-4
    at_palm = wrench[:3] - np.cross(hand.R_WF @ palm.p_FC, force)
    pressure = np.array([-at_palm[1], at_palm[0]]) / force[2]
    assert (np.abs(pressure) <= 0.02 + 1e-4).all()


def test_a_leaning_hand_takes_no_part_in_the_gravity_compensation(robot, qp, terms):
    rail = Contact(HAND, PATCH, 100.0, support_share=0.0)
    contacts = (*soles(robot), rail)
    crossed = EffortBounds(
        robot.effort_limit, -robot.effort_limit, np.zeros(robot.num_joints, dtype=bool)
    )
    solution = qp.solve(terms, still(robot, contacts=contacts), crossed)
    assert not solution.found
    np.testing.assert_array_equal(solution.contact_wrenches[HAND], 0.0)
    for foot in robot.file.feet:
        wrench = solution.contact_wrenches[foot.sole_frame]
        assert wrench[5] == pytest.approx(0.5 * robot.mass * GRAVITY)


@pytest.mark.parametrize(
    "corners",
    [
        [[0.1, 0.1], [-0.1, 0.1]],
        [[0.1, 0.1], [0.1, -0.1], [-0.1, -0.1], [-0.1, 0.1]],
        [[0.1, 0.1], [-0.1, 0.1], [0.0, 0.09], [-0.1, -0.1]],
    ],
    ids=["two corners", "clockwise", "not convex"],
)
def test_a_patch_is_a_convex_polygon(corners):
    with pytest.raises(ValueError, match="corners"):
        ContactPatch(np.array(corners), 0.5, 0.05)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("row", "limit"), [(3, 0.6 / 2**0.5), (4, 0.6 / 2**0.5), (2, 0.6 * 0.05)]
)
def test_a_patch_limits_friction_and_yaw_moment_both_ways(row, limit, sign):
    for share, holds in ((0.99, True), (1.01, False)):
        wrench = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 10.0])
        wrench[row] = 10.0 * sign * share * limit
        assert (PATCH.cone[:-1] @ wrench <= 0.0).all() == holds


def test_a_patch_takes_what_forces_at_its_corners_sum_up_to_and_no_more():
    at_rest = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 10.0])
    random, size = np.random.default_rng(0), np.array([0.5, 1.0, 1.0, 5.0, 5.0, 0.0])
    taken, turning = 0, PATCH.friction * PATCH.yaw_moment_arm
    for _ in range(200):
        wrench = at_rest + size * random.uniform(-1.0, 1.0, 6)
        taken += (within := (PATCH.cone[:-1] @ wrench <= 0.0).all())
        gentle = abs(wrench[2]) <= turning * wrench[5]
        assert within == (gentle and corner_forces_exist(PATCH, wrench))
    assert 15 < taken < 185


def corner_forces_exist(patch, wrench):
    """Asks whether forces within friction at the corners sum up to a wrench."""
    program, friction = MathematicalProgram(), patch.friction / 2**0.5
    force = program.NewContinuousVariables(len(patch.corners), 3)
    for x, y, normal in force:
        program.AddLinearConstraint(normal >= 0.0)
        for side in (x, -x, y, -y):
            program.AddLinearConstraint(side <= friction * normal)
    moments = [np.cross([*corner, 0.0], np.eye(3)).T for corner in patch.corners]
    forces = np.tile(np.eye(3), len(moments))
    total = np.concatenate([np.hstack(moments), forces])
    program.AddLinearEqualityConstraint(total, wrench, force.ravel())
    return ClpSolver().Solve(program).is_success()


def test_a_patch_keeps_the_pressure_in_its_polygon():
    triangle = np.array([[0.1, 0.0], [-0.1, 0.1], [-0.1, -0.1]])
    patch = ContactPatch(triangle, 0.5, 0.05)

    def holds(x, y):
        # A force of 10 N along the normal at (x, y).
        wrench = np.array([10.0 * y, -10.0 * x, 0.0, 0.0, 0.0, 10.0])
        return (patch.cone[:-1] @ wrench <= 1e-9).all()

    assert holds(0.0, 0.0)
    assert holds(-0.09, 0.09)
    assert not holds(0.05, 0.05)
    assert not holds(-0.11, 0.0)


class OwnTask(Task):
    """Rows as they are given."""

    def __init__(self, A=None, b=ZERO, G=None, weight=1.0):
        self.given, self.target, self.weight = (A, b, G), ZERO, weight

    def rows(self, terms, contacts):
        return TaskRows(*self.given)


class RowlessTask(OwnTask):
    """A task whose author forgot to return."""

    def rows(self, terms, contacts):
        return None


UNUSABLE = {
    "no frame 'tail'": PositionTask("tail", ZERO, 1.0),
    "target of FrameTask on 'l_hand'": FrameTask(HAND, ZERO, 1.0),
    "weight of FrameTask on 'l_hand'": FrameTask(HAND, np.zeros(6), np.ones(3)),
    "target of PostureTask": PostureTask(ZERO, 1.0),
    "A of OwnTask": OwnTask(A=np.zeros((3, 33))),
    "b of OwnTask": OwnTask(b=np.zeros((3, 1))),
    "G of OwnTask": OwnTask(A=np.eye(3, 34), G=np.eye(3)),
    "weight of OwnTask": OwnTask(A=np.eye(3, 34), weight="x"),
    "rows of RowlessTask": RowlessTask(),
}


@pytest.mark.parametrize(("name", "task"), UNUSABLE.items(), ids=UNUSABLE)
def test_a_part_of_another_shape_is_named(robot, qp, bounds, terms, name, task):
    with pytest.raises((TypeError, ValueError), match=name):
        qp.solve(terms, still(robot, task, contacts=soles(robot)), bounds)


def test_other_parts_of_another_shape_are_named_too(robot, qp, bounds, terms):
    good = still(robot)
    short = replace(good.posture, target=np.zeros(27))
    with pytest.raises(ValueError, match="command's posture"):
        qp.solve(terms, replace(good, posture=short), bounds)
    with pytest.raises(TypeError, match="tasks"):
        good.plus(3)
    limits = TaskBounds(ComTask(ZERO, 1.0), np.zeros(2), 1.0)
    with pytest.raises(ValueError, match="lower of TaskBounds of ComTask"):
        qp.solve(terms, good.plus(constraints=[limits]), bounds)
    for kind, name, value in (
        (OrientationTask, "R_WD", ZERO),
        (PositionTask, "p_WD", ZERO[:2]),
        (PositionTask, "p_WD", "up"),
    ):
        with pytest.raises(ValueError, match=f"{name} of {kind.__name__}"):
            kind.tracking(terms, HAND, gains=GAINS, weight=1.0, **{name: value})


HAND_TASK = PositionTask(HAND, np.ones(3), 1.0)
CROSSED = TaskBounds(ComTask(ZERO, 1.0), np.array([1.0, -9.0, -9.0]), -ZERO)
BEYOND = TaskBounds(ComTask(ZERO, 1.0), 50.0, 60.0, soft=False)
REASONS = {
    "target of PositionTask": replace(HAND_TASK, target=np.full(3, np.nan)),
    "weight of PositionTask on 'l_hand' is not finite": replace(
        HAND_TASK, weight=np.inf
    ),
    "weight of PositionTask on 'l_hand' is 1e\\+20": replace(HAND_TASK, weight=1e20),
    "weight of PositionTask on 'l_hand' is negative": replace(HAND_TASK, weight=-5.0),
    "A of OwnTask": OwnTask(A=np.full((3, 34), np.nan)),
    "bounds of TaskBounds of ComTask contradict": CROSSED,
    "the hard bounds": BEYOND,
}


@pytest.mark.parametrize(("why", "part"), REASONS.items(), ids=REASONS)
@pytest.mark.filterwarnings("ignore:invalid value")
def test_the_part_that_leaves_no_solution_is_named(robot, qp, bounds, terms, why, part):
    # One row of three is at fault, behind bounds that may stay.
    fine = TaskBounds(HAND_TASK, -1e3, 1e3)
    command = still(robot, HAND_TASK, contacts=soles(robot)).plus(constraints=[fine])
    assert qp.solve(terms, command, bounds).why == ""
    parts = [part] if isinstance(part, Task) else []
    bad = command.plus(*parts, constraints=[part] if not parts else ())
    answer = qp.solve(terms, bad, bounds)
    assert not answer.found
    assert re.match(why, answer.why)


@pytest.mark.filterwarnings("ignore:invalid value")
def test_a_state_that_is_no_number_is_named(robot, qp, bounds, terms):
    lost = replace(terms, v=np.full_like(terms.v, np.nan))
    answer = qp.solve(lost, still(robot, contacts=soles(robot)), bounds)
    assert answer.why == "the state of the robot is not finite"


def test_the_patch_of_a_hand_is_that_of_the_robots_file(robot):
    entry = ContactEntry(name="palm", frame=HAND, length=0.04, width=0.10)
    patch = ContactPatch.of_entry(entry, ContactModel())
    np.testing.assert_allclose(np.abs(patch.corners), [[0.02, 0.05]] * 4)
    for entry in robot.file.contacts:
        patch = ContactPatch.of_entry(robot.contact(entry.name), ContactModel())
        # A push along the normal at the patch's center is what it can take best.
        normal = patch.R_FC[:, 2]
        wrench = np.concatenate([np.cross(patch.p_FC, normal), normal])
        assert (patch.cone[:-1] @ wrench < 0.0).all()
        assert patch.cone[-1] @ wrench == pytest.approx(1.0)
