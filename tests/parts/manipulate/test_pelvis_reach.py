"""The possible poses of the pelvis, on every robot."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from atlas_drake.messages.footstep import FootPose
from atlas_drake.parts.manipulate.pelvis_pose import (
    PelvisPose,
    PelvisRange,
    make_stance,
)
from atlas_drake.parts.manipulate.pelvis_reach import PelvisReach, PelvisReserves
from atlas_drake.robot.soles import sole_corners
from atlas_drake.support_polygon import SupportPolygon
from tests.parts.conftest import TUTORIAL_ROBOTS

pytestmark = pytest.mark.parametrize(
    "robot", TUTORIAL_ROBOTS, indirect=True, scope="session"
)

RANGE = PelvisRange()
RESERVES = PelvisReserves(
    com_margin=0.04, joint_margin=0.05, least_flexion=0.12, effort_share=0.8
)
HOME = PelvisPose(0.89)
COORDINATES = PelvisPose._fields


def stance_of(robot, feet):
    sole = robot.file.sole
    corners = [
        sole_corners(foot.p_WF, foot.R_WF, sole.length / 2, sole.width / 2)
        for foot in feet
    ]
    return make_stance(*feet, SupportPolygon(np.concatenate(corners)))


@dataclasses.dataclass
class Case:
    """One robot in the stand-prep pose."""

    reach: PelvisReach
    stance: object
    upper: object

    def clamp(self, **commanded):
        return self.reach.clamp(
            HOME._replace(**commanded), HOME, self.stance, self.upper
        )

    def allows(self, pose):
        return self.reach.allows(pose, self.stance, self.upper)


@pytest.fixture(scope="module")
def case(model, standing):
    reach = PelvisReach(model.robot)
    feet = [FootPose(foot.p_WF, foot.R_WF) for foot in standing.feet]
    stance = stance_of(model.robot, feet)
    return Case(reach, stance, reach.upper_body(standing, stance))


@pytest.mark.parametrize("name", COORDINATES)
@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("size", [3.0, 1e300])
def test_each_coordinate_is_clamped_by_itself(model, case, name, sign, size):
    granted = case.clamp(**{name: sign * size})
    assert case.allows(granted)
    moved = getattr(granted, name) - getattr(HOME, name)
    assert moved * sign > 0.02
    assert granted._replace(**{name: getattr(HOME, name)}) == HOME
    # A little further on it is either beyond the box or beyond the legs.
    further = granted._replace(**{name: getattr(granted, name) + sign * 0.003})
    box = {"com_v0": "com", "com_v1": "com"}.get(name, name)
    low, high = getattr(RANGE, box)
    if name == "height":
        low, high = np.array([low, high]) + model.robot.pelvis_height
    assert not (low <= getattr(further, name) <= high and case.allows(further))


@settings(max_examples=12)
@given(
    commanded=st.tuples(
        st.floats(0.3, 1.2), *[st.floats(-1.5, 1.5)] * 3, *[st.floats(-0.4, 0.4)] * 2
    )
)
def test_every_commanded_pose_is_clamped_to_a_stable_one(case, commanded):
    granted = case.clamp(**PelvisPose(*commanded)._asdict())
    assert case.allows(granted)
    assert case.clamp(**granted._asdict()) == granted
    outside = case.stance.support.distance_outside(case.stance.com(granted))
    assert outside <= -RESERVES.com_margin + 1e-9


def test_weaker_knees_raise_the_lowest_pose(model, case):
    weak = PelvisReach(
        model.robot, RANGE, dataclasses.replace(RESERVES, effort_share=0.4)
    )
    low = weak.clamp(HOME._replace(height=0.3), HOME, case.stance, case.upper)
    assert low.height > case.clamp(height=0.3).height + 0.02


def test_the_hips_turn_no_further_than_their_stops(model, case):
    stop = model.robot.position_lower[model.robot.joint_index("l_leg_hpz")]
    yaw = case.clamp(yaw=1.0).yaw
    assert yaw == pytest.approx(-stop - RESERVES.joint_margin, abs=2e-3)


def test_feet_far_apart_bring_home_down(model, standing, case):
    feet = [FootPose(foot.p_WF, foot.R_WF) for foot in standing.feet]
    feet[0] = FootPose(feet[0].p_WF + np.array([0.4, 0.15, 0.0]), feet[0].R_WF)
    stance = stance_of(model.robot, feet)
    assert not case.reach.allows(HOME, stance, case.upper)
    home = case.reach.attainable(HOME, stance, case.upper)
    assert case.reach.allows(home, stance, case.upper)
    assert 0.6 < home.height < HOME.height


def test_the_upper_body_is_what_is_left_without_the_legs(model, case, standing):
    robot, plant, context = model.robot, model.plant, model.create_context()
    state = np.zeros(model.num_states)
    state[0] = 1.0
    state[robot.indices(plant).q] = robot.stand_prep
    model.evaluate(context, state)
    legs = robot.limb("l_leg", "r_leg")
    beyond = {
        plant.GetJointByName(name).child_body().index()
        for name, in_a_leg in zip(robot.joint_names, legs, strict=True)
        if in_a_leg
    }
    total, moment = 0.0, np.zeros(3)
    pelvis = plant.GetBodyByName(robot.file.pelvis)
    for index in plant.GetBodyIndices(pelvis.model_instance()):
        body = plant.get_body(index)
        if index not in beyond:
            mass = body.get_mass(context)
            place = plant.EvalBodyPoseInWorld(context, body)
            total += mass
            moment += mass * (place @ body.CalcCenterOfMassInBodyFrame(context))
    # The legs are taken to be straight lines: only along x do bent knees show.
    np.testing.assert_allclose(case.upper[1:], (moment / total)[1:], atol=2e-3)
