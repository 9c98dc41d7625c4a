"""Work of the hands: their motions and the robot's walks, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple
from typing import Any

import numpy as np

from atlas_drake.clients.steering.hand_motion import HandMotion
from atlas_drake.clients.steering.step_stream import StepStream
from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages import (
    AtlasBehaviorPelvisServoParams,
    AtlasSimInterfaceCommand,
    Behavior,
)
from atlas_drake.planning.footstep_planner import steps_to
from atlas_drake.planning.hand_goal import HandGoal
from atlas_drake.planning.reach import Reach
from atlas_drake.planning.whole_body_reach import whole_body_reach
from atlas_drake.simulation.atlas_simulation import AtlasSimulation

_BENT = 2e-3
"""Difference of a pose of the pelvis from where it has to be [m, rad]."""


class HandWork:
    """A simulation and its hands. Each act lasts until it is done, or the robot falls.

    Hands with a goal keep it, in the frame of the goal: one in the world while the
    robot stands, and one of the pelvis or the trunk also while it walks. The frame may
    also be one of something else, such as ``crate``: then the goal is where that is as
    the act begins.
    """

    SETTLING = 0.3
    """Time that hands are given at the end of a motion [s]."""

    def __init__(self, sim: AtlasSimulation) -> None:
        """Works with the hands of a simulation."""
        self._sim, self._hands = sim, HandMotion(sim.robot)
        self._busy = False

    def bend(self, goals: Sequence[HandGoal], patience: float = 10.0) -> None:
        """Brings the pelvis to where hands can reach their goals, by MANIPULATE.

        Args:
            goals: At most one for each hand, to ``move`` there next.
            patience: Longest time that it takes [s].

        Raises:
            InvalidMessageError: If a goal is out of reach of the whole body, or
                MANIPULATE does not bring the pelvis there.
        """
        sim = self._sim
        config: Any = sim.scenario.controller_config()
        found, pelvis = whole_body_reach(
            sim.robot,
            sim.output("state"),
            self._placed(goals),
            config.manipulate.range,
        )
        found.check()
        command = AtlasSimInterfaceCommand(behavior=Behavior.MANIPULATE)
        command.manipulate_params.use_desired = True
        command.manipulate_params.desired = pelvis
        sim.publish(command)
        give_up = sim.time + patience
        while self._go_on() and not self._is_bent() and sim.time < give_up:
            pass
        clamped = sim.atlas_sim_interface_state.manipulate_feedback.clamped
        if not sim.has_fallen and not _near(clamped, pelvis):
            problem = f"MANIPULATE does not bring the pelvis there: {pelvis}"
            raise InvalidMessageError("goals", found.positions.tolist(), problem)

    def move(self, goals: Sequence[HandGoal], duration: float) -> Reach:
        """Moves hands to their goals along straight lines.

        Args:
            goals: At most one for each hand; a hand without one is the behavior's.
            duration: Time in which they get there [s].

        Returns:
            What the arms reach of it, as seen from the start: a direction that they
            cannot have is not refused, ``angles`` say how far it is missed.

        Raises:
            InvalidMessageError: If a place is out of reach.
        """
        sim = self._sim
        state = sim.output("state")
        there = self._hands.aim(sim.time, state, self._placed(goals), duration)
        self._busy = True
        while not self._hands.is_there(sim.time - self.SETTLING):
            if not self._go_on():
                break
        return there

    def hold(self, duration: float = 0.5) -> None:
        """Keeps the hands where they are at the chest from now on.

        Args:
            duration: Time until they are [s].
        """
        sim = self._sim
        self.move(self._hands.carried(sim.time, sim.output("state")), duration)

    def walk_to(self, x: float, y: float, yaw: float) -> None:
        """Walks to a place in W, with the hands as they are.

        Args:
            x: Of the middle between the soles [m].
            y: Of the middle between the soles [m].
            yaw: Heading there [rad].
        """
        sim = self._sim
        walk = StepStream(steps_to(sim.atlas_sim_interface_state, x, y, yaw))
        while not walk.is_over(sim.atlas_sim_interface_state):
            sim.publish(walk.next_command(sim.atlas_sim_interface_state))
            if not self._go_on():
                return

    def _placed(self, goals: Sequence[HandGoal]) -> list[HandGoal]:
        """Returns the goals, those in the frame of something else in W."""
        sim = self._sim

        def placed(goal: HandGoal) -> HandGoal:
            plant = sim.robot.plant
            if plant.HasFrameNamed(sim.robot.pushed_link(goal.frame)):
                return goal
            try:
                return goal.in_world(sim.frame_pose(goal.frame))
            except ValueError as error:
                raise InvalidMessageError("frame", goal.frame, str(error)) from error

        return [placed(goal) for goal in goals]

    def _is_bent(self) -> bool:
        """Returns True once MANIPULATE's reference of the pelvis is at its goal."""
        if self._sim.current_behavior is not Behavior.MANIPULATE:
            return False
        feedback = self._sim.atlas_sim_interface_state.manipulate_feedback
        return _near(feedback.clamped, feedback.internal_desired)

    def _go_on(self) -> bool:
        """Simulates until the next command of the hands; False once the robot fell."""
        sim = self._sim
        if self._busy:
            sim.publish(self._hands.command(sim.time, sim.output("state")))
        sim.advance(self._hands.PERIOD)
        return not sim.has_fallen


def _near(
    one: AtlasBehaviorPelvisServoParams, other: AtlasBehaviorPelvisServoParams
) -> bool:
    return np.allclose(astuple(one), astuple(other), atol=_BENT)
