"""Plans of single steps of STEP: heel, posture, knee torque and shortening."""

import numpy as np
import pytest

from atlas_drake.behaviors.balance import Balance, StanceConfig
from atlas_drake.control.feet.footstep import outward
from atlas_drake.control.feet.leg_kinematics import highest_com, knee_ahead
from atlas_drake.control.feet.sole_motion import pitched_pose
from atlas_drake.control.feet.step_limits import quasi_static_limits
from atlas_drake.control.gains import ControlGains
from atlas_drake.frozen import replace
from atlas_drake.messages import ToeOff
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep, StepAction
from atlas_drake.parts.step.config import PostureRules
from atlas_drake.parts.step.plan import StepPlanner
from atlas_drake.rotations import rotation_z

RULES = PostureRules(knee_efforts=(0.78, 0.90), steepest_heel=0.6, forced_heel=0.3)
HALF_WIDTH = 0.14


@pytest.fixture(scope="module")
def planner(robot, observe):
    terms = observe().terms
    height = float(terms.com[2] - terms.feet[0].p_WF[2]) - StanceConfig().com_drop
    return StepPlanner(
        Balance(robot, ControlGains()), height, quasi_static_limits(), PostureRules()
    )


@pytest.fixture
def seen(observe):
    """The robot's terms and the poses of its feet."""
    observation = observe()
    return observation.terms, (observation.foot_pose(0), observation.foot_pose(1))


def step_of(feet, foot, ahead=0.0, aside=HALF_WIDTH, rise=0.0, **action):
    """A step to a place seen from the middle of the feet, ``aside`` outward."""
    middle = 0.5 * (feet[0].p_WF + feet[1].p_WF)
    place = middle + np.array([ahead, outward(foot) * aside, rise])
    step = Footstep(1, foot, place, 0.0, 0.7, 0.1)
    return replace(step, action=StepAction(**action))


def test_plans_of_both_feet_are_mirror_images(planner, seen):
    terms, feet = seen
    left, right = (
        planner.plan(terms, feet, step_of(feet, foot, 0.15, rise=0.1))
        for foot in (LEFT, RIGHT)
    )
    for name in ("lean", "heel", "height", "ceiling"):
        assert getattr(left, name) == pytest.approx(getattr(right, name), abs=2e-3)
    np.testing.assert_allclose(left.com, right.com * [1.0, -1.0], atol=2e-3)
    np.testing.assert_allclose(left.hips, right.hips[::-1] * [1, -1, 1], atol=2e-3)


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize(("inward", "is_planned"), [(-0.2, True), (0.29, False)])
def test_a_weight_shift_that_a_hip_does_not_reach_is_not_planned(
    planner, seen, foot, inward, is_planned
):
    # The foot is far behind and aside; the hip turns inward by 0.17 rad only.
    terms, feet = seen[0], list(seen[1])
    stance, side = feet[1 - foot], outward(foot)
    p_WF = stance.p_WF + np.array([-0.30, 0.38 * side, 0.0])
    feet[foot] = FootPose(p_WF, rotation_z(-inward * side))
    desired = step_of(seen[1], foot)
    assert (planner.plan(terms, tuple(feet), desired) is not None) == is_planned


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize("behind", [0.0, 0.2, 0.4])
def test_the_heel_rises_as_far_as_the_body_needs(planner, seen, foot, behind):
    terms, feet = seen[0], list(seen[1])
    p_WF = feet[foot].p_WF - np.array([behind, 0.0, 0.0])
    feet[foot] = FootPose(p_WF, feet[foot].R_WF)

    def plan(setting):
        desired = step_of(seen[1], foot, toe_off=setting)
        return planner.posture(terms, feet, desired, 0.0), desired

    flat, desired = plan(ToeOff.DISABLE)
    free, _ = plan(ToeOff.ENABLE)
    forced, _ = plan(ToeOff.FORCE_ENABLE)
    assert flat.heel == 0.0
    assert (free.heel > 0.0) == (behind > 0.1)
    assert forced.heel == max(free.heel, RULES.forced_heel)
    # A flat foot holds the body down, unless it is held down by the landing.
    assert (
        flat.height <= free.height <= planner.height(desired.action) + feet[0].p_WF[2]
    )

    def highest(heel):
        pose = pitched_pose(feet[foot], heel, planner.half_length)
        return highest_com(planner.legs, free.hips, free.com, [(foot, pose)])

    if free.heel:
        # The next smaller angle of the search is not enough.
        assert free.heel <= RULES.steepest_heel
        needed = free.height - RULES.drop
        assert highest(free.heel) > needed > flat.height
        assert highest(free.heel - RULES.steepest_heel / 12) < free.height


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize("rise", [0.05, 0.15])
def test_a_step_up_is_planned_with_what_the_standing_knee_can_carry(
    planner, seen, robot, foot, rise
):
    (terms, feet), leans = seen, []
    stance = 1 - foot
    leg = planner.legs[stance]
    for heavier in (1.0, 2.0, 4.0):
        loaded = Balance(robot, ControlGains())
        loaded.weight *= heavier
        plan = StepPlanner(
            loaded,
            planner.height(StepAction(knee_nominal=planner.nominal_knee)),
            planner.limits,
            RULES,
        ).plan(terms, feet, step_of(feet, foot, 0.15, rise=rise))
        com = np.append(plan.com, plan.height)
        lever = knee_ahead(leg, plan.hips[stance], com, feet[stance])
        most = RULES.knee_efforts[-1] * robot.effort_limit[leg.knee]
        assert lever * loaded.weight < most + 1.0
        assert plan.lean <= RULES.lean
        leans.append(plan.lean)
    # The heavier the robot, the farther it leans over the knee.
    assert leans == sorted(leans)
    assert leans[0] < leans[-1]


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_a_step_is_shortened_towards_the_place_beside_the_other_foot(
    planner, seen, foot
):
    stance = FootPose(seen[1][1 - foot].p_WF, rotation_z(0.5))
    side = outward(foot) * np.array([0.0, 1.0, 0.0])
    far, beside = np.array([0.4, 0.0, 0.0]) + 0.3 * side, StanceConfig().width * side
    step = Footstep(1, foot, stance.p_WF + stance.R_WF @ far, 0.5, 0.7, 0.1)
    nearer = planner.shortened(step, stance, 0.4)
    way = stance.R_WF.T @ (nearer.p_WF - stance.p_WF) - beside
    np.testing.assert_allclose(way, 0.4 * (far - beside), atol=1e-9)
