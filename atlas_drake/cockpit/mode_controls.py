"""Behaviors: which can be asked for now, and what goes with them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.cockpit.joint_controls import JointControls
from atlas_drake.cockpit.pelvis_controls import PelvisControls
from atlas_drake.cockpit.walk_controls import WalkControls
from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasSimInterfaceCommand,
    Behavior,
)
from atlas_drake.messages.behavior_catalog import BehaviorInterface
from atlas_drake.messages.footstep import LEFT
from atlas_drake.planning.footholds import foothold, step_data, step_from

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

_USERS = (Behavior.USER, Behavior.NONE)


class ModeControls:
    """Asks for behaviors, each with what people expect to go with it.

    WALK begins on the spot, STEP takes one step ahead, MANIPULATE keeps the pose, USER
    takes all joints as they are and the next behavior gets back what it had.
    """

    def __init__(
        self,
        sim: AtlasSimulation,
        walk: WalkControls,
        joints: JointControls,
        pelvis: PelvisControls,
    ) -> None:
        """Uses the other controls for steps, joints and pelvis."""
        self._sim, self._walk, self._joints, self._pelvis = sim, walk, joints, pelvis
        self._step_foot = LEFT
        self._shares_before_user: np.ndarray | None = None

    def request(self, name: str, params: Mapping[str, Any] | None = None) -> None:
        """Asks for a behavior.

        Args:
            name: Name of the behavior.
            params: Parameters of a behavior of the user's own, by field.
        """
        sim = self._sim
        behavior = sim.behaviors.find(name)
        if behavior is Behavior.WALK and params is None:
            self._give_back(behavior)
            self._walk.steer()
            return
        command = AtlasSimInterfaceCommand(behavior=behavior)
        if params is not None:
            kind = sim.behaviors.entry(behavior).params
            if kind is None:
                raise InvalidMessageError("params", params, f"{name} has none")
            command.params = kind(**params)
        elif behavior is Behavior.STEP:
            self._fill_step(command)
        elif behavior is Behavior.MANIPULATE:
            self._pelvis.begin()
        self._walk.let_go()
        self._give_back(behavior)
        sim.publish(command)

    def stop(self) -> None:
        """Comes to rest: a walk ends with its next step, all else becomes STAND."""
        if self._sim.current_behavior == Behavior.WALK:
            self._walk.stop()
        else:
            self.request("STAND")

    def refusals(self) -> dict[str, str]:
        """Returns why a behavior would be refused now, by name; empty if it would not.

        Only what the order of behaviors says is known before a request.
        """
        source = self._sim.behaviors.entry(self._sim.current_behavior)
        fallen = self._sim.has_fallen
        catalog = self._sim.behaviors
        return {
            entry.name: refusal_in_words(entry, source, catalog, fallen=fallen)
            for entry in catalog
        }

    def _fill_step(self, command: AtlasSimInterfaceCommand) -> None:
        """Requests one step ahead, with alternating feet."""
        report, gait = self._sim.atlas_sim_interface_state, self._walk.gait
        active = report.current_behavior == Behavior.STEP
        index = report.step_feedback.next_step_index_needed if active else 1
        foot = self._step_foot
        stance = foothold(report.foot_pos_est[1 - foot])
        place = step_from(stance, foot, gait, gait.stride, 0.0, 0.0)
        command.step_params.desired_step = step_data(index, foot, place, gait)
        command.step_params.use_relative_step_height = True
        self._step_foot = 1 - foot

    def _give_back(self, behavior: Behavior) -> None:
        """Gives USER all joints as they are, and the next behavior its joints back."""
        was_users = self._sim.current_behavior in _USERS
        shares = np.array(self._sim.output("commands").joints.k_effort)
        if behavior == Behavior.USER and not was_users:
            self._shares_before_user = shares
            self._joints.set_shares(np.full(len(shares), K_EFFORT_MAX))
        elif was_users and behavior not in _USERS:
            before = self._shares_before_user
            self._joints.set_shares(np.zeros(len(shares)) if before is None else before)
            self._shares_before_user = None


def refusal_in_words(
    entry: BehaviorInterface,
    source: BehaviorInterface,
    catalog: Iterable[BehaviorInterface],
    *,
    fallen: bool,
) -> str:
    """Returns why a behavior would be refused after another; empty if it would not.

    Args:
        entry: The behavior that is asked for.
        source: The active behavior.
        catalog: All behaviors.
        fallen: True for a robot that lies on the ground.
    """
    if not isinstance(entry, BehaviorEntry) or not isinstance(source, BehaviorEntry):
        return ""  # A controller of the user's own has rules of its own.
    if fallen and entry.upright:
        return "The robot has fallen: reset it"
    before = [
        one
        for one in catalog
        if isinstance(one, BehaviorEntry) and one is not entry and entry.may_follow(one)
    ]
    # WALK is reached through STAND.
    on_the_way = entry.behavior is Behavior.WALK and "STAND" in source.leads_to
    if on_the_way or entry.may_follow(source):
        return ""
    names = ", ".join(one.name for one in before) or "no other behavior"
    return f"{entry.name} may follow {names}, not {source.name}"
