"""The entries of the behaviors that stand and walk, and of those without balance."""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.base import BehaviorProtocol
from atlas_drake.behaviors.entry import BehaviorTools, Transition, entry_of
from atlas_drake.behaviors.idle import Idle
from atlas_drake.behaviors.stand.stand import StandConfig
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.walk import Walk
from atlas_drake.control.balance import feedback
from atlas_drake.control.whole_body.terms import mean_sole_height
from atlas_drake.messages import Behavior, BehaviorStatus


def can_be_brought_to_rest(asked: Transition) -> BehaviorStatus:
    """Checks that CoM, DCM and joint speeds are within the limits of STAND's entry.

    Where a step may be taken, the DCM may be outside the soles, and a leg may swing.
    """
    if asked.source.balanced:
        return BehaviorStatus.OK
    observation, tools = asked.observation, asked.tools
    limits, terms = tools.entry_limits, observation.terms
    steps = tools.recovery.may_step(observation)
    support = tools.balance.support(*observation.foot_poses)
    if support.distance_outside(terms.com[:2]) > -limits.com_inside:
        return BehaviorStatus.FAILED_TRANS_COM_POS
    omega = observation.pendulum_frequency(mean_sole_height(terms))
    dcm = feedback.dcm(terms, omega)
    outside = limits.dcm_outside if steps else -limits.dcm_inside
    if support.distance_outside(dcm) > outside:
        return BehaviorStatus.FAILED_TRANS_COM_VEL
    caught = ~observation.user_held
    if steps:
        caught &= ~tools.robot.limb("l_leg", "r_leg")
    if float(np.abs(terms.v[caught]).max(initial=0.0)) > limits.joint_speed:
        return BehaviorStatus.FAILED_TRANS_VEL
    return BehaviorStatus.OK


def _stand(tools: BehaviorTools, _config: StandConfig) -> BehaviorProtocol:
    return tools.stand()


_UNBALANCED = {
    "follows": (),
    "leads_to": ("STAND_PREP", "STAND"),
    "balanced": False,
    "ends_in_order": False,
}
_ANY_TIME = {**_UNBALANCED, "at_any_time": True, "upright": False}
"""Such behaviors may be requested at any time, for safety."""

NONE = entry_of(Behavior.NONE, make=lambda _tools, _config: Idle(), **_ANY_TIME)
FREEZE = entry_of(
    Behavior.FREEZE, make=lambda tools, _config: tools.freeze, **_ANY_TIME
)
STAND_PREP = entry_of(
    Behavior.STAND_PREP,
    make=_stand,
    config=StandConfig(),
    config_field="stand",
    **_UNBALANCED,
)
STAND = entry_of(
    Behavior.STAND,
    make=_stand,
    config=StandConfig(),
    conditions=(can_be_brought_to_rest,),
    follows=(),
    leads_to=("STAND_PREP",),
    ends_in_order=False,
    recovers=True,
)
WALK = entry_of(Behavior.WALK, make=Walk, config=WalkConfig(), lifts_feet=True)
USER = entry_of(Behavior.USER, make=lambda _tools, _config: Idle(), **_ANY_TIME)
