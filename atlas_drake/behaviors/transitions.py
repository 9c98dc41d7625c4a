"""Which behaviour may follow which, and the conditions for entering one.

One table. What a behaviour does once it is entered is its own file's business.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import Observation
from atlas_drake.control.balance import feedback
from atlas_drake.control.whole_body.model import mean_sole_height
from atlas_drake.messages import Behavior, BehaviorStatus

_ALWAYS = frozenset({Behavior.NONE, Behavior.FREEZE, Behavior.USER})
"""Safety comes first: these may be asked for at any moment."""

LEGAL_TRANSITIONS: dict[Behavior, frozenset[Behavior]] = {
    Behavior.NONE: _ALWAYS | {Behavior.STAND_PREP, Behavior.STAND},
    Behavior.FREEZE: _ALWAYS | {Behavior.STAND_PREP, Behavior.STAND},
    Behavior.USER: _ALWAYS | {Behavior.STAND_PREP, Behavior.STAND},
    Behavior.STAND_PREP: _ALWAYS | {Behavior.STAND_PREP, Behavior.STAND},
    Behavior.STAND: _ALWAYS
    | {
        Behavior.STAND_PREP,
        Behavior.STAND,
        Behavior.WALK,
        Behavior.STEP,
        Behavior.MANIPULATE,
    },
    Behavior.WALK: _ALWAYS | {Behavior.STAND, Behavior.WALK},
    Behavior.STEP: _ALWAYS | {Behavior.STAND, Behavior.STEP},
    Behavior.MANIPULATE: _ALWAYS | {Behavior.STAND, Behavior.MANIPULATE},
}
"""From each behaviour to those that may follow. WALK and STEP lead only to STAND."""

LEAVES_IN_ORDER = frozenset({Behavior.WALK, Behavior.STEP, Behavior.MANIPULATE})
"""Behaviours that STAND does not interrupt: they end by themselves when it is asked
for. WALK and STEP finish their step, MANIPULATE goes back to STAND's pose."""


@dataclass(frozen=True)
class EntryLimits:
    """When STAND can take over; measured by ``benchmarks/entry_limits.py``."""

    com_inside: float = 0.01
    """The CoM must lie this far inside the soles' hull less its margins [m]."""
    dcm_inside: float = 0.03
    """And the DCM this far, which is where it would come to rest by itself [m]."""
    joint_speed: float = 4.0
    """Fastest joint that the behaviour would have to catch [rad/s]."""


def refusal(
    source: Behavior,
    target: Behavior,
    seen: Observation,
    balance: Balance,
    limits: EntryLimits,
) -> BehaviorStatus:
    """Why ``target`` cannot follow ``source`` now; OK when it can."""
    if target not in LEGAL_TRANSITIONS[source]:
        return BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR
    standing = {Behavior.STAND} | LEAVES_IN_ORDER
    if target is not Behavior.STAND or source in standing:
        return BehaviorStatus.OK
    terms = seen.terms
    support = balance.support(seen.foot_pose(0), seen.foot_pose(1))
    if support.distance_outside(terms.com[:2]) > -limits.com_inside:
        return BehaviorStatus.FAILED_TRANS_COM_POS
    omega = feedback.pendulum_frequency(float(terms.com[2]) - mean_sole_height(terms))
    dcm = feedback.dcm(terms, omega)
    if support.distance_outside(dcm) > -limits.dcm_inside:
        return BehaviorStatus.FAILED_TRANS_COM_VEL
    if float(np.abs(terms.v[~seen.user_held]).max(initial=0.0)) > limits.joint_speed:
        return BehaviorStatus.FAILED_TRANS_VEL
    return BehaviorStatus.OK
