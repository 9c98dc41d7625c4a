"""The commands that ``Balance`` makes of references, and the region of the CoP."""

import math

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand
from atlas_drake.behaviors.body_reference import capture_body
from atlas_drake.behaviors.supervisor import Supervisor
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.feet.sole_motion import SoleMotion
from atlas_drake.control.whole_body import EffortBounds, WholeBodyQp
from atlas_drake.control.whole_body.tasks import OrientationTask
from atlas_drake.frozen import replace
from atlas_drake.messages import Behavior
from atlas_drake.messages.footstep import FootPose
from atlas_drake.rotations import rotation_x, rotation_z
from atlas_drake.shipped import BEHAVIORS, CONTROLLER
from atlas_drake.units import GRAVITY

from .conftest import as_request

OMEGA = 3.2
FOOT = FootPose(np.array([1.0, 0.5, 0.0]), np.eye(3))


@pytest.mark.parametrize("side", [0, 1])
def test_the_cop_stays_inside_the_sole_by_a_margin(balance, side):
    sole, contact = balance.robot.file.sole, balance.gains.contact
    margin = (contact.length_margin, contact.width_margin)[side]
    edge = 0.5 * (sole.length, sole.width)[side] - margin
    for sign in (-1.0, 1.0):
        far = FOOT.p_WF[:2].copy()
        far[side] += sign * 10.0
        expected = FOOT.p_WF[:2].copy()
        expected[side] += sign * edge
        clamped = balance.support(FOOT).clamp(far)
        np.testing.assert_allclose(clamped[side], expected[side], atol=1e-12)


def test_a_swinging_foot_is_pulled_to_its_reference(balance, observe):
    seen, gains = observe(), balance.gains.swing_position
    foot = seen.terms.feet[1]
    ahead, faster, sooner = np.array([[0.03, -0.02, 0.01], [0.1, 0.2, -0.3], [1, 2, 3]])
    reference = SoleMotion(
        p_WF=foot.p_WF + ahead,
        v_WF=foot.V_WF[3:] + faster,
        a_WF=sooner,
        R_WF=foot.R_WF,
        w_WF=foot.V_WF[:3],
        alpha_WF=sooner,
    )
    command = balance.swinging(seen, 1, reference)
    expected = sooner + gains.kp * ahead + gains.kd * faster
    np.testing.assert_allclose(command.task.target[3:], expected)
    np.testing.assert_allclose(command.task.target[:3], sooner, atol=1e-9)
    assert command.contact is None


@pytest.mark.parametrize(
    ("felt", "limit"),
    [(-0.1, 0.15), (0.0, 0.15), (0.05, 0.275), (0.2, 0.65), (3.0, 3.0), (np.nan, 3.0)],
)
def test_a_planted_sole_is_trusted_with_little_more_than_it_carries(
    balance, observe, felt, limit
):
    seen = replace(observe(), foot_force=np.full(2, felt * balance.weight))
    contact = balance.in_contact(seen, 1).contact
    assert contact.max_normal_force == pytest.approx(limit * balance.weight)
    # Where it carries next to nothing, a moment would only turn the foot.
    reach = np.abs(contact.patch.corners).max()
    assert (reach < 0.02) == (felt < 0.15)
    # What the behavior itself allows is never exceeded.
    less = balance.in_contact(seen, 1, max_load=0.05).contact
    assert less.max_normal_force == pytest.approx(0.05 * balance.weight)


@pytest.mark.parametrize("slope", [0.0, 0.2])
def test_a_planted_sole_without_load_is_counted_on_near_its_ground(
    balance, observe, slope
):
    contact, sole = balance.gains.contact, observe().terms.feet[1]
    turn = rotation_x(slope)
    standing = sole._replace(R_WF=sole.R_WF @ turn)
    for height, felt, share in (
        (0.5 * contact.near, 0.0, contact.near_share),
        (0.5 * contact.near, 0.5, contact.unloaded_share + 0.5 * contact.load_growth),
        (1.5 * contact.near, 0.0, contact.unloaded_share),
    ):
        ground = standing.p_WF - height * standing.R_WF[:, 2]
        seen = observe()
        terms = replace(seen.terms, feet=(seen.terms.feet[0], standing))
        seen = replace(seen, terms=terms, foot_force=np.full(2, felt * balance.weight))
        planted = FootPose(ground, standing.R_WF)
        command = balance.in_contact(seen, 1, planted=planted)
        limit = command.contact.max_normal_force
        assert limit == pytest.approx(share * balance.weight)


def test_a_planted_sole_without_load_is_pressed_down_and_flat(balance, observe):
    seen = observe()
    sole = seen.terms.feet[1]
    planted = FootPose(sole.p_WF - [0.0, 0.0, 0.004], sole.R_WF @ rotation_x(-0.1))
    for share, pressed in ((0.5, False), (0.05, False), (0.0, True)):
        seen = replace(seen, foot_force=np.full(2, share * balance.weight))
        target = balance.standing(seen, (planted, planted))[1].task.target
        down = balance.gains.swing_position.kp * (balance.gains.contact.pressed + 0.004)
        turn = balance.gains.swing_orientation.kp * math.sin(-0.1)
        expected = (turn, -down) if pressed else (0.0, 0.0)
        np.testing.assert_allclose(target[[0, 5]], expected, rtol=1e-3, atol=1e-6)
    # Without a place to stand it only comes to rest.
    assert not balance.in_contact(seen, 1).task.target.any()


def commanded(balance, seen, *, body=None, dcm=None):
    """The command to a robot on both feet; without references, to stay as it is."""
    feet = (balance.in_contact(seen, 0), balance.in_contact(seen, 1))
    dcm = feedback.dcm(seen.terms, OMEGA) if dcm is None else dcm
    support = balance.support(*(seen.foot_pose(foot) for foot in (0, 1)))
    body = body or capture_body(seen.terms)
    reference = DcmReference(dcm, dcm)
    return balance.command(seen, body, reference, OMEGA, support, feet)


def test_what_soles_and_trunk_cannot_give_moves_no_leg(balance, observe):
    middle = np.mean([foot.p_WF[:2] for foot in observe().terms.feet], axis=0)
    seen = observe(above=middle)
    for side in (1.0, -1.0):
        far, farther = (
            commanded(balance, seen, dcm=middle + np.array([0.0, side * error]))
            .tasks[5]
            .target
            for error in (0.3, 3.0)
        )
        assert side * far[1] > 1.0
        assert farther[1] == pytest.approx(far[1], abs=0.01)


def test_a_robot_at_its_reference_is_left_at_rest(balance, observe):
    middle = np.mean([foot.p_WF[:2] for foot in observe().terms.feet], axis=0)
    seen = observe(above=middle)
    command = commanded(balance, seen)
    left, right, chest, pelvis, moment, com, internal = command.tasks
    frames = [contact.frame for contact in command.contacts]
    assert frames == [left.frame, right.frame] == list(internal.frames)
    for task in (left, right, chest, pelvis, com):
        np.testing.assert_allclose(task.target, 0.0, atol=1e-9)
    np.testing.assert_allclose(command.posture.target, 0.0, atol=1e-9)
    # The force points from the eCMP to the center of mass, which it carries.
    np.testing.assert_allclose(moment.p_WE[:2], middle, atol=1e-9)
    arm = seen.terms.com[2] - moment.p_WE[2]
    assert arm * OMEGA**2 == pytest.approx(GRAVITY)


def test_on_its_toes_a_foot_carries_only_at_its_tip(balance):
    length, width = balance.robot.file.sole.length, balance.robot.file.sole.width
    for yaw in (0.0, 1.2):
        foot = FootPose(FOOT.p_WF, rotation_z(yaw))
        toes = balance.toes(foot)
        places = (toes.vertices - foot.p_WF[:2]) @ rotation_z(yaw)[:2, :2]
        np.testing.assert_allclose(places[:, 0].max(), 0.5 * length)
        assert 0.01 < np.ptp(places[:, 0]) < 0.05
        across = np.abs(places[:, 1])
        assert (across > 0.4 * width).all()
        assert (across < 0.5 * width).all()
        # With the other foot flat, the CoP may be anywhere between both.
        flat = FootPose(foot.p_WF + rotation_z(yaw) @ [0.0, 0.3, 0.0], foot.R_WF)
        both = balance.support_on_toes(flat, foot)
        for share in (0.0, 0.5, 1.0):
            tip = foot.p_WF[:2] + (0.5 * length - 0.01) * foot.R_WF[:2, 0]
            place = share * flat.p_WF[:2] + (1.0 - share) * tip
            assert both.distance_outside(place) < 0.0
        heel = foot.p_WF[:2] - 0.3 * length * foot.R_WF[:2, 0]
        assert both.distance_outside(heel) > 0.0


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("error", [-0.01, 0.01])
def test_the_center_of_mass_is_pushed_back_to_its_reference(
    balance, observe, axis, error
):
    middle = np.mean([foot.p_WF[:2] for foot in observe().terms.feet], axis=0)
    away = middle.copy()
    away[axis] += error
    *_, moment, com, _ = commanded(balance, observe(above=away), dcm=middle).tasks
    # ξ̇ = ω(ξ - p): the error of the DCM shrinks at the rate k·ω, but for the legs,
    # which turn with the body: the CoP goes a little farther, and the CMP not as far.
    full = balance.gains.dcm_gain * error
    assert 1.0 < (moment.p_WE[axis] - away[axis]) / full < 1.1
    assert 0.9 < com.target[axis] / (-(OMEGA**2) * full) < 1.0
    assert com.target[1 - axis] == pytest.approx(0.0, abs=1e-9)


def test_trunk_and_posture_are_turned_to_their_reference(balance, observe):
    seen = observe()
    body = capture_body(seen.terms)
    ahead = replace(
        body, yaw_rate=0.3, height=body.height + 0.01, joints=body.joints + 0.1
    )
    command = commanded(balance, seen, body=ahead)
    _, _, chest, pelvis, _, com, _ = command.tasks
    gains = balance.gains
    for task in (chest, pelvis):
        spin = [0.0, 0.0, 0.3 * gains.orientation.kd]
        np.testing.assert_allclose(task.target, spin, atol=1e-9)
    assert com.target[2] == pytest.approx(0.01 * gains.com_height.kp)
    np.testing.assert_allclose(command.posture.target, 0.1 * gains.posture.kp)
    # With the back under the user's control, the chest may not tilt the pelvis.
    shared = commanded(balance, observe(users={"back_bkz": 1.0}), body=ahead)
    turned = [task for task in shared.tasks if isinstance(task, OrientationTask)]
    assert [task.frame for task in turned] == [balance.robot.file.pelvis]


@pytest.mark.parametrize("behavior", ["STAND", "WALK", "STEP", "MANIPULATE"])
def test_every_behavior_begins_with_each_foot_planted(model, observe, behavior):
    seen = observe()
    made = Supervisor(model, CONTROLLER, 0.9, BEHAVIORS).behaviors[Behavior[behavior]]
    request = as_request(AtlasSimInterfaceCommand(behavior=behavior))
    body = capture_body(seen.terms)
    state = made.enter(seen, body, request)
    outcome = made.update(state, seen, body, request, False)
    assert (outcome.status_flags != 0) == (behavior in ("WALK", "STEP"))
    command = outcome.command
    soles = [foot.sole_frame for foot in model.robot.file.feet]
    assert [contact.frame for contact in command.contacts] == soles
    assert [task.frame for task in command.tasks[:2]] == soles


@pytest.fixture
def on_one_leg(balance, model, observe, robot):
    """Solves for a robot on its left leg; the right foot is asked up or down.

    Its knee is bent by an angle [rad] from the stand-prep pose, the body turns with
    ``w_WP`` [rad/s], and the motors of the wrists are as strong as ``wrists`` [N·m].
    Returns the acceleration of the foot, and the force on the sole.
    """
    left, right = 0, 1
    indices, leg = robot.indices(model.plant), robot.legs[right]

    def solve(bend, asked, w_WP=(0.0, 0.0, 0.0), wrists=math.inf):
        q = robot.stand_prep.copy()
        q[leg.knee] += bend
        for name in ("r_leg_hpy", "r_leg_aky"):
            q[robot.joint_names.index(name)] -= 0.5 * bend
        state = np.zeros(model.num_states)
        state[0] = 1.0
        state[indices.q] = q
        velocity = model.plant.num_positions()
        state[velocity : velocity + 3] = w_WP
        terms = model.evaluate(model.create_context(), state)
        stance, foot = terms.feet
        carried = np.array([balance.weight, 0.0])
        seen = replace(observe(), terms=terms, foot_force=carried)
        moved = SoleMotion(
            p_WF=foot.p_WF,
            v_WF=foot.V_WF[3:],
            a_WF=np.array([0.0, 0.0, asked]),
            R_WF=foot.R_WF,
            w_WF=foot.V_WF[:3],
            alpha_WF=np.zeros(3),
        )
        feet = balance.in_contact(seen, left), balance.swinging(seen, right, moved)
        command = balance.command(
            seen,
            capture_body(terms),
            DcmReference(terms.com[:2], stance.p_WF[:2]),
            OMEGA,
            balance.support(seen.foot_pose(left)),
            feet,
        )
        limit = robot.effort_limit.copy()
        for index, name in enumerate(robot.joint_names):
            if "arm_wr" in name:
                limit[index] = min(limit[index], wrists)
        bounds = EffortBounds(-limit, limit, np.zeros(robot.num_joints, dtype=bool))
        solution = WholeBodyQp(robot, balance.gains).solve(terms, command, bounds)
        assert solution.found
        # The stance sole comes to rest, which gives the pelvis' acceleration.
        joints = solution.joint_acceleration
        rest = feet[left].task.target - stance.J_WF[:, 6:] @ joints - stance.bias
        pelvis = np.linalg.solve(stance.J_WF[:, :6], rest)
        acceleration = foot.J_WF @ np.concatenate([pelvis, joints]) + foot.bias
        sole = robot.file.feet[left].sole_frame
        return acceleration, solution.contact_wrenches[sole][5]

    return solve


def test_a_foot_that_lifts_off_fast_does_not_throw_the_body_up(
    balance, robot, on_one_leg
):
    """A high swing begins with an almost straight knee."""
    leg = robot.legs[1]
    bend = 0.15 + leg.straight - robot.stand_prep[leg.knee]
    _, pushed = on_one_leg(bend, 40.0)
    assert pushed < 1.5 * balance.weight


def test_a_foot_comes_down_although_the_trunk_is_righted(on_one_leg):
    """A swing leg that rights the trunk lands late, and the DCM runs away."""
    asked = -40.0
    acceleration, _ = on_one_leg(0.3, asked, w_WP=[3.0, 0.0, 0.0])
    assert acceleration[5] < 0.5 * asked


def test_a_spin_of_the_body_does_not_turn_the_foot_in_the_air(on_one_leg):
    """A punch on an arm spins the robot; stopping that at once takes the swing leg."""
    (still, _), (spun, _) = (on_one_leg(0.3, -40.0, [0.0, 0.0, w]) for w in (0.0, 3.0))
    assert abs(spun[2] - still[2]) < 5.0


def test_a_jolt_that_weak_wrists_cannot_bear_does_not_move_the_foot(on_one_leg):
    """The hand turns, as its motor cannot hold it; no other joint makes up for it."""
    jolt = 0.3, -40.0, [15.0, 15.0, 0.0]
    (strong, _), (weak, _) = on_one_leg(*jolt), on_one_leg(*jolt, wrists=0.01)
    assert np.abs(weak - strong).max() < 30.0  # Of 200 rad/s² that the trunk asks for.
