"""Hands that a viewer moves in the 3D view: how they would be, and the way there."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import Any

import numpy as np
from pydrake.math import RigidTransform

from atlas_drake.clients.steering.hand_motion import HandMotion
from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages import AtlasCommand
from atlas_drake.planning.hand_goal import HandGoal
from atlas_drake.planning.palms import arms_of, context_of, palm_of
from atlas_drake.planning.reach import TOLERANCE, reach
from atlas_drake.simulation import AtlasSimulation

SPEED, TURNING = 0.25, 0.8
"""Mean speeds of a hand on its way [m/s, rad/s]."""
SHORTEST, SETTLING = 1.0, 1.0
"""Shortest duration of a way, and time to come to rest after it [s]."""


class Hands:
    """The hands of a simulation, of which one is on its way at a time.

    Once it has got there its arm stays as it is, and the user's.
    """

    def __init__(self, sim: AtlasSimulation) -> None:
        """Moves no hand yet."""
        self._sim = sim
        self._motion: HandMotion | None = None
        self._arm = np.zeros(len(sim.robot.joint_names), dtype=bool)
        self._next, self._begins = 0.0, False

    def plan(
        self, hand: str, position_W: Sequence[float], orientation_W: Sequence[float]
    ) -> dict[str, Any]:
        """Returns how the arm is once the hand is there, or as near as it gets.

        Args:
            hand: Body of the hand.
            position_W: Of the palm, in W [m].
            orientation_W: Of the hand's frame in W, a quaternion [w, x, y, z].

        Returns:
            ``links``: pose in W of each link of the arm, a matrix by columns, by name;
            ``distance`` and ``angle``: how far the hand stays away [m, rad]; whether it
            is ``near`` enough to be sent there.

        Raises:
            InvalidMessageError: If there is no such hand, or no such pose.
        """
        robot, state = self._sim.robot, self._sim.output("state")
        goal = HandGoal(hand, position_W, orientation=orientation_W)
        found = reach(robot, state, [goal])
        context = context_of(robot, state, found.joints)

        def pose(link: str) -> RigidTransform:
            return robot.plant.GetFrameByName(link).CalcPoseInWorld(context)

        moved = [robot.moved_links[i] for i in np.flatnonzero(arms_of(robot, [goal]))]
        links = {
            link: pose(link).GetAsMatrix4().ravel(order="F").tolist()
            for link in chain.from_iterable(moved)
        }
        return {
            "links": links,
            "distance": float(found.distances[0]),
            "near": bool(found.distances[0] <= TOLERANCE),
            "angle": float(found.angles[0]),
        }

    def move(
        self, hand: str, position_W: Sequence[float], orientation_W: Sequence[float]
    ) -> float:
        """Takes the arm, and lets the hand go there; returns how long it takes [s].

        Args:
            hand: Body of the hand.
            position_W: Of the palm, in W [m].
            orientation_W: Of the hand's frame in W, a quaternion [w, x, y, z].

        Raises:
            InvalidMessageError: If the hand does not get there, or the robot has
                fallen; a hand that is on its way goes on.
        """
        sim = self._sim
        if sim.has_fallen:
            problem = "the robot has fallen: reset it before its hands move"
            raise InvalidMessageError("hand", hand, problem)
        goal = HandGoal(hand, position_W, orientation=orientation_W)
        arm = arms_of(sim.robot, [goal])
        motion, duration = HandMotion(sim.robot), self._duration(goal)
        motion.aim(sim.time, sim.output("state"), [goal], duration)
        self.stop()
        self._motion, self._arm, self._next = motion, arm, sim.time
        self._begins = True
        return duration

    def stop(self) -> None:
        """Leaves a hand that is on its way where it is."""
        if self._motion is None:
            return
        self._motion = None
        velocity = self._sim.output("commands").joints.velocity
        self._sim.publish(AtlasCommand(velocity=np.where(self._arm, 0.0, velocity)))

    def attend(self) -> None:
        """Sends the next command of a hand that is on its way, if it is time."""
        sim, motion = self._sim, self._motion
        if motion is None or sim.time < self._next - 1e-9:
            return
        others = sim.output("commands").joints
        is_taken = not self._begins and (others.k[self._arm] < 1.0).any()
        if sim.has_fallen or is_taken:
            self.stop()
            return
        self._next, self._begins = sim.time + motion.PERIOD, False
        sim.publish(motion.command(sim.time, sim.output("state"), others))
        if motion.is_there(sim.time - SETTLING):
            self.stop()

    def _duration(self, goal: HandGoal) -> float:
        """Returns the time for a way from where the hand is [s]."""
        X_WH = self._sim.frame_pose(goal.hand)
        way = np.array(goal.position) - X_WH @ palm_of(self._sim.robot, goal)
        turn = (X_WH.rotation().inverse() @ goal.rotation).ToAngleAxis().angle()
        return max(float(np.linalg.norm(way)) / SPEED, turn / TURNING, SHORTEST)
