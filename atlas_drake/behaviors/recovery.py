"""When a standing robot has to step: WALK then takes over, and catches the balance."""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.stand.stand import StandConfig
from atlas_drake.control.balance import feedback
from atlas_drake.control.whole_body.terms import mean_sole_height
from atlas_drake.frozen import replace
from atlas_drake.messages import AtlasSimInterfaceCommand, Behavior
from atlas_drake.messages.commands import BehaviorRequest


class Recovery:
    """Determines when a step is needed. Holds constants only."""

    def __init__(self, balance: Balance, config: StandConfig):
        self._balance = balance
        self._config = config
        self._legs = np.flatnonzero(balance.robot.limb("l_leg", "r_leg"))
        sole, contact = balance.robot.file.sole, balance.gains.contact
        self._half_width = sole.width / 2 - contact.width_margin

    def is_needed(self, observation: Observation) -> bool:
        """Returns True if no CoP under the feet keeps the DCM bounded."""
        if not self.may_step(observation):
            return False
        config = self._config
        terms = observation.terms
        omega = observation.pendulum_frequency(mean_sole_height(terms))
        dcm = feedback.dcm(terms, omega)
        airborne = self._balance.airborne(observation)
        if airborne is not None:
            support = self._balance.support(observation.foot_pose(1 - airborne))
        elif self._is_between_the_feet(dcm, observation):
            return False
        else:
            support = self._balance.support(*observation.foot_poses)
        return support.distance_outside(dcm) > config.recovery_margin

    def may_step(self, observation: Observation) -> bool:
        """Returns True if a step may be taken for balance.

        Both legs have to be free for it, not under the user's control, and one of them
        has to carry the robot.
        """
        config = self._config
        if not config.recovery_steps or observation.k[self._legs].any():
            return False
        load = float(observation.foot_force.sum()) / self._balance.weight
        return load > config.recovery_load  # NaN at the first tick.

    def _is_between_the_feet(self, dcm: np.ndarray, observation: Observation) -> bool:
        """Returns True if the DCM is near the line from sole to sole.

        It is then inside the support polygon, which takes ten times as long to compute.
        """
        left, right = (foot.p_WF[:2] for foot in observation.terms.feet)
        across = right - left
        share = float((dcm - left) @ across) / float(across @ across)
        aside = dcm - left - min(max(share, 0.0), 1.0) * across
        return float(np.hypot(*aside)) < self._half_width


def walk_without_steps(last: BehaviorRequest) -> BehaviorRequest:
    """Returns a request for WALK without steps, as old as the ``last`` request."""
    command = AtlasSimInterfaceCommand(behavior=Behavior.WALK).freeze()
    return replace(last, behavior=Behavior.WALK, command=command)
