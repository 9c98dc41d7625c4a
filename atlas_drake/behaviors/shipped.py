"""The entries of the shipped behaviors, made in the same way as the user's own."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from atlas_drake.behaviors.base import BehaviorProtocol
from atlas_drake.behaviors.entry import BehaviorEntry, BehaviorTools, Transition
from atlas_drake.behaviors.idle import Idle
from atlas_drake.behaviors.manipulate.manipulate import Manipulate, ManipulateConfig
from atlas_drake.behaviors.stand.stand import StandConfig
from atlas_drake.behaviors.step.config import StepConfig
from atlas_drake.behaviors.step.step import Step
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.walk import Walk
from atlas_drake.control.balance import feedback
from atlas_drake.control.whole_body.model import mean_sole_height
from atlas_drake.messages import Behavior, BehaviorStatus
from atlas_drake.messages.behavior_catalog import SHIPPED


def at_rest_over_the_feet(asked: Transition) -> BehaviorStatus:
    """Checks that CoM, DCM and joint speeds are within the limits of STAND's entry."""
    if asked.source.balanced:
        return BehaviorStatus.OK
    observation, limits = asked.observation, asked.tools.entry_limits
    terms = observation.terms
    support = asked.tools.balance.support(*observation.foot_poses)
    if support.distance_outside(terms.com[:2]) > -limits.com_inside:
        return BehaviorStatus.FAILED_TRANS_COM_POS
    omega = observation.pendulum_frequency(mean_sole_height(terms))
    dcm = feedback.dcm(terms, omega)
    if support.distance_outside(dcm) > -limits.dcm_inside:
        return BehaviorStatus.FAILED_TRANS_COM_VEL
    if (
        float(np.abs(terms.v[~observation.user_held]).max(initial=0.0))
        > limits.joint_speed
    ):
        return BehaviorStatus.FAILED_TRANS_VEL
    return BehaviorStatus.OK


def _stand(tools: BehaviorTools, config: StandConfig) -> BehaviorProtocol:
    return tools.stand(config=config)


def _manipulate(tools: BehaviorTools, config: ManipulateConfig) -> BehaviorProtocol:
    return tools.guarded(Manipulate(tools, config))


def _entry(behavior: Behavior, **how: Any) -> BehaviorEntry:
    """Makes the entry of a behavior of the original interface."""
    interface = SHIPPED.entry(behavior)
    shared = {field.name: getattr(interface, field.name) for field in fields(interface)}
    return BehaviorEntry(**{**shared, "follows": (), **how})


_UNBALANCED = {
    "leads_to": ("STAND_PREP", "STAND"),
    "balanced": False,
    "ends_in_order": False,
}
_ANY_TIME = {**_UNBALANCED, "at_any_time": True, "upright": False}
"""Such behaviors may be requested at any time, for safety."""

SHIPPED_ENTRIES = (
    _entry(Behavior.NONE, make=lambda _tools, _config: Idle(), **_ANY_TIME),
    _entry(Behavior.FREEZE, make=lambda tools, _config: tools.freeze, **_ANY_TIME),
    _entry(
        Behavior.STAND_PREP,
        make=_stand,
        config=StandConfig(),
        config_field="stand",
        **_UNBALANCED,
    ),
    _entry(
        Behavior.STAND,
        make=_stand,
        config=StandConfig(),
        conditions=(at_rest_over_the_feet,),
        leads_to=("STAND_PREP", "WALK", "STEP", "MANIPULATE"),
        ends_in_order=False,
        recovers=True,
    ),
    _entry(Behavior.WALK, make=Walk, config=WalkConfig(), lifts_feet=True),
    _entry(
        Behavior.STEP,
        make=Step,
        config=StepConfig(),
        lifts_feet=True,
        recovers=True,
    ),
    _entry(
        Behavior.MANIPULATE, make=_manipulate, config=ManipulateConfig(), recovers=True
    ),
    _entry(Behavior.USER, make=lambda _tools, _config: Idle(), **_ANY_TIME),
)
"""In the order of their numbers."""


def shipped_entry(behavior: Behavior) -> BehaviorEntry:
    """Returns the entry of a shipped behavior, from which you can make your own.

    Example:
        >>> walk = shipped_entry(Behavior.WALK)
        >>> replace(walk, name="MARCH", number=100, make=March, follows=("STAND",))

    Args:
        behavior: A behavior of the original interface.
    """
    return next(entry for entry in SHIPPED_ENTRIES if entry.behavior is behavior)
