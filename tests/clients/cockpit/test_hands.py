"""A hand goes where a viewer of the page has dragged its goal."""

import numpy as np
import pytest
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix

from atlas_drake import Behavior, InvalidMessageError

ARM = "l_arm"
FREEZE = {"behavior": "FREEZE"}


def palm(run):
    """Where the left palm is, and how the hand is turned."""
    X_WH = run.sim.frame_pose("l_hand")
    return X_WH @ np.array(run.sim.robot.palms["l_hand"]), X_WH.rotation()


def goal(run, shift_W, turn=0.0):
    """What the page sends of a goal that was dragged and turned a little."""
    p_WP, R_WH = palm(run)
    R_WG = RotationMatrix(RollPitchYaw(0.0, 0.0, turn)) @ R_WH
    return {
        "hand": "l_hand",
        "position_W": (p_WP + shift_W).tolist(),
        "orientation_W": R_WG.ToQuaternion().wxyz().tolist(),
    }


def pass_(run, seconds):
    """Lets time pass as a run with a page does."""
    for _ in range(round(seconds / 0.02)):
        run.page.watch()
        run.sim.advance(0.02)


@pytest.mark.slow
def test_a_hand_gets_there_as_previewed_and_only_its_arm_changes_hands(run):
    robot = run.sim.robot
    asked = goal(run, [0.12, 0.03, 0.2], turn=0.2)
    ghost = run.do("plan_hand", **asked)
    assert ghost["distance"] < 1e-3
    duration = run.do("move_hand", **asked)
    pass_(run, duration + 1.0)
    p_WP, R_WH = palm(run)
    np.testing.assert_allclose(p_WP, asked["position_W"], atol=2e-3)
    X_WG = RigidTransform(np.reshape(ghost["links"]["l_hand"], (4, 4)).T)
    turned = (X_WG.rotation().inverse() @ R_WH).ToAngleAxis().angle()
    assert abs(turned) < np.radians(3.0)
    shares = run.sim.output("commands").joints.k_effort
    np.testing.assert_array_equal(shares > 0, robot.limb(ARM))
    assert run.sim.current_behavior is Behavior.STAND


@pytest.mark.slow
def test_the_other_arm_keeps_what_the_user_told_it(run):
    robot, right = run.sim.robot, run.sim.robot.limb("r_arm")
    command = {
        "position": (robot.stand_prep + 0.1 * right).tolist(),
        "k_effort": np.where(right, 200, 0).tolist(),
    }
    run.do("message", atlas_command=command)
    run.sim.advance(0.02)
    before = run.sim.output("commands").joints
    run.do("move_hand", **goal(run, [0.1, 0.0, 0.1]))
    pass_(run, 0.3)
    after = run.sim.output("commands").joints
    assert (after.k_effort[robot.limb(ARM)] == 255).all()
    for name in ("position", "velocity", "kp_position", "kp_velocity", "k_effort"):
        kept = getattr(before, name)[right]
        np.testing.assert_array_equal(getattr(after, name)[right], kept)


@pytest.mark.slow
@pytest.mark.parametrize(
    "ends",
    [
        lambda run: run.do("stop_hand"),
        lambda run: run.do("message", atlas_command={"k_effort": [0] * 28}),
        lambda run: run.do("reset"),
    ],
    ids=["STOP", "giving the arm back", "a reset"],
)
def test_a_way_ends_by(run, ends):
    run.do("move_hand", **goal(run, [0.12, 0.0, 0.25]))
    pass_(run, 0.5)
    ends(run)
    pass_(run, 0.04)
    commands = run.sim.output("commands").joints
    assert not commands.velocity.any()
    pass_(run, 1.0)
    assert run.sim.output("commands").joints is commands


@pytest.mark.slow
def test_a_hand_that_is_stopped_stays_where_it_is(run):
    run.do("move_hand", **goal(run, [0.12, 0.0, 0.25]))
    pass_(run, 0.7)
    run.do("stop_hand")
    stopped = palm(run)[0]
    pass_(run, 1.0)
    np.testing.assert_allclose(palm(run)[0], stopped, atol=0.02)


@pytest.mark.slow
def test_a_behavior_lets_the_hand_go_on(run):
    asked = goal(run, [0.12, 0.0, 0.25])
    duration = run.do("move_hand", **asked)
    run.do("message", atlas_sim_interface_command={"behavior": "MANIPULATE"})
    pass_(run, duration + 1.0)
    np.testing.assert_allclose(palm(run)[0], asked["position_W"], atol=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"hand": "l_hnd"}, "no such hand"),
        ({"position_W": [1.0, 2.0]}, "position"),
        ({"position_W": [0.1, 0.1, float("nan")]}, "position"),
        ({"orientation_W": [0.0, 0.0, 0.0, 0.0]}, "orientation"),
        ({"position_W": [5.0, 0.0, 1.0]}, "cannot reach it"),
    ],
)
def test_what_cannot_be_reached_is_refused_and_the_way_before_goes_on(
    run, change, named
):
    first = goal(run, [0.12, 0.0, 0.2])
    duration = run.do("move_hand", **first)
    with pytest.raises(InvalidMessageError, match=named):
        run.do("move_hand", **goal(run, [0.0, 0.0, 0.0]) | change)
    pass_(run, duration + 1.0)
    np.testing.assert_allclose(palm(run)[0], first["position_W"], atol=2e-3)


def test_a_robot_that_has_fallen_moves_no_hand(run):
    run.sim.apply_push("trunk", [4000.0, 0.0, 0.0], 0.2)
    while not run.sim.has_fallen:
        run.sim.advance(0.1)
    with pytest.raises(InvalidMessageError, match="fallen"):
        run.do("move_hand", **goal(run, [0.1, 0.0, 0.1]))
