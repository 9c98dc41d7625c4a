"""Minutes of changing one's mind as a trial: random but legal mode switching.

Behaviors, shares of control and set-points are drawn anew every few seconds. What a
script may ask for and no robot survives is left out: NONE, taking a leg while it
balances, and anything but STAND in the middle of a step. The limits are in
``mode_switching.yaml``.
"""

from __future__ import annotations

import gc
import resource
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from atlas_drake import (
    K_EFFORT_MAX,
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    Pose,
    Quaternion,
    Vector3,
)

PAUSE = (0.4, 3.0)
"""Time between two actions [s]."""
USER_LIMBS = ("l_arm", "r_arm", "neck")
"""Limbs that the user takes and returns while the behavior balances."""
USER_KP, USER_KP_VELOCITY = 200.0, 20.0
"""Gains of the limbs that the user takes [N·m/rad], [N·m·s/rad]."""
REACH = 0.5
"""Range of the user's set-points about stand-prep [rad]."""
ALL_USERS = 2.0
"""Time for which the robot stands on the joint controllers alone [s]."""
PATIENCE = 12.0
"""Longest wait for a walk or a pose to end [s]."""


class Mind:
    """Draws random actions, all from one generator."""

    def __init__(self, sim: AtlasSimulation, seed: int):
        self.sim = sim
        self.random = np.random.default_rng(seed)
        self.done: Counter[str] = Counter()
        self.acts: dict[str, Callable[[], None]] = {
            "take limbs": self.take_limbs,
            "blend limbs": self.blend_limbs,
            "give all back": self.give_back,
            "walk": self.walk,
            "walk, then STAND": self.walk_and_stop,
            "step": self.step,
            "manipulate": self.manipulate,
            "freeze": self.freeze,
            "user": self.user,
        }

    def change(self) -> str:
        """Performs one action, and returns its name."""
        name = str(self.random.choice(list(self.acts)))
        self.acts[name]()
        self.done[name] += 1
        self.sim.advance(float(self.random.uniform(*PAUSE)))
        return name

    # ---- shares --------------------------------------------------------------

    def take_limbs(self) -> None:
        """Takes full control of some limbs."""
        self._limbs(lambda: K_EFFORT_MAX)

    def blend_limbs(self) -> None:
        """Takes a share of some limbs."""
        self._limbs(lambda: int(self.random.integers(1, K_EFFORT_MAX)))

    def give_back(self) -> None:
        """Returns every joint to the behavior."""
        command = AtlasCommand()
        command.k_effort = [0] * self.sim.robot.num_joints
        self.sim.publish(command)

    def _limbs(self, share: Callable[[], int]) -> None:
        robot, random = self.sim.robot, self.random
        k_effort = np.zeros(robot.num_joints, dtype=int)
        for limb in USER_LIMBS:
            if random.random() < 0.6:
                k_effort[robot.limb(limb)] = share()
        wanted = robot.stand_prep + random.uniform(-REACH, REACH, robot.num_joints)
        command = AtlasCommand()
        command.position = np.clip(wanted, robot.position_lower, robot.position_upper)
        command.kp_position = [USER_KP] * robot.num_joints
        command.kd_position = [0.0] * robot.num_joints
        command.kp_velocity = [USER_KP_VELOCITY] * robot.num_joints
        command.k_effort = k_effort
        self.sim.publish(command)

    # ---- behaviors ----------------------------------------------------------

    def _ask(self, behavior: Behavior) -> AtlasSimInterfaceCommand:
        return AtlasSimInterfaceCommand(behavior=behavior)

    def _stand(self) -> None:
        """Returns to STAND from any behavior."""
        sim = self.sim
        if sim.current_behavior is not Behavior.STAND:
            sim.publish(self._ask(Behavior.STAND))
        self._until(lambda: sim.current_behavior is Behavior.STAND)

    def _until(self, reached: Callable[[], bool]) -> None:
        end = self.sim.time + PATIENCE
        while not reached() and self.sim.time < end and not self.sim.has_fallen:
            self.sim.advance(0.1)

    def _queue(self) -> AtlasSimInterfaceCommand:
        """Makes four steps in a random direction, from the present footholds."""
        random = self.random
        feet = self.sim.atlas_sim_interface_state.foot_pos_est
        x, y = (np.mean([getattr(f.position, axis) for f in feet]) for axis in "xy")
        z = float(np.mean([f.position.z for f in feet]))
        yaw = _yaw(feet[0].orientation)
        stride = float(random.uniform(-0.15, 0.25))
        turn = float(random.uniform(-0.15, 0.15))
        first = int(random.integers(2))
        command = self._ask(Behavior.WALK)
        for place in range(4):
            foot = (first + place) % 2
            yaw += turn
            share = 1.0 if place < 3 else 0.0
            x += share * stride * np.cos(yaw)
            y += share * stride * np.sin(yaw)
            side = 0.12 if foot == 0 else -0.12
            command.walk_params.step_queue[place] = AtlasBehaviorStepData(
                step_index=place + 1,
                foot_index=foot,
                duration=float(random.uniform(0.63, 0.9)),
                swing_height=float(random.uniform(0.05, 0.2)),
                pose=_pose(x - side * np.sin(yaw), y + side * np.cos(yaw), z, yaw),
            )
        return command

    def walk(self) -> None:
        """Four steps, to the end."""
        self._stand()
        self.sim.publish(self._queue())
        self.sim.advance(0.1)
        self._until(lambda: self.sim.current_behavior is Behavior.STAND)

    def walk_and_stop(self) -> None:
        """Four steps, and STAND at any moment of them."""
        self._stand()
        self.sim.publish(self._queue())
        self.sim.advance(float(self.random.uniform(0.1, 3.0)))
        self._stand()

    def step(self) -> None:
        """One quasi-static step."""
        self._stand()
        command = self._ask(Behavior.STEP)
        foot = int(self.random.integers(2))
        place = self.sim.atlas_sim_interface_state.foot_pos_est[foot]
        yaw = _yaw(place.orientation)
        forward = float(self.random.uniform(-0.1, 0.15))
        command.step_params.desired_step = AtlasBehaviorStepData(
            step_index=1,
            foot_index=foot,
            duration=1.0,
            swing_height=0.1,
            pose=_pose(
                place.position.x + forward * np.cos(yaw),
                place.position.y + forward * np.sin(yaw),
                place.position.z,
                yaw,
            ),
        )
        self.sim.publish(command)
        self.sim.advance(float(self.random.uniform(1.0, 6.0)))
        self._stand()

    def manipulate(self) -> None:
        """A few poses of the pelvis."""
        self._stand()
        command, random = self._ask(Behavior.MANIPULATE), self.random
        command.manipulate_params.use_desired = True
        for _ in range(int(random.integers(1, 4))):
            wish = command.manipulate_params.desired
            wish.pelvis_height = float(random.uniform(0.6, 0.95))
            wish.pelvis_yaw, wish.pelvis_pitch, wish.pelvis_roll = map(
                float, random.uniform(-0.2, 0.2, 3)
            )
            wish.com_v0 = float(random.uniform(-0.1, 0.1))
            wish.com_v1 = float(random.uniform(-0.05, 0.05))
            self.sim.publish(command)
            self.sim.advance(float(random.uniform(0.3, 2.0)))
        self._stand()

    def freeze(self) -> None:
        """Holds still for a while."""
        self._stand()
        self.sim.advance(1.0)
        self.sim.publish(self._ask(Behavior.FREEZE))
        self.sim.advance(float(self.random.uniform(0.1, 1.5)))
        self._stand()

    def user(self) -> None:
        """The joint controllers alone, in the stand-prep pose, as in the tutorial."""
        sim, robot = self.sim, self.sim.robot
        self.give_back()
        self._stand()
        sim.advance(2.0)
        command = AtlasCommand()
        command.position = list(sim.atlas_state.position)
        command.kp_position, command.kd_position = robot.default_kp, robot.default_kd
        command.kp_velocity = [0.0] * robot.num_joints
        # Starts with the present efforts, so that nothing sags.
        command.effort = list(sim.atlas_state.effort)
        command.k_effort = [K_EFFORT_MAX] * robot.num_joints
        sim.publish(command)
        sim.publish(self._ask(Behavior.USER))
        sim.advance(float(self.random.uniform(0.1, ALL_USERS)))
        back = AtlasCommand()
        back.effort = [0.0] * robot.num_joints
        sim.publish(back)
        stand = self._ask(Behavior.STAND)
        stand.k_effort = [0] * robot.num_joints
        sim.publish(stand)
        sim.advance(0.1)
        self._stand()


def _pose(x: float, y: float, z: float, yaw: float) -> Pose:
    half = 0.5 * yaw
    return Pose(
        position=Vector3(float(x), float(y), float(z)),
        orientation=Quaternion(0.0, 0.0, float(np.sin(half)), float(np.cos(half))),
    )


def _yaw(q: Quaternion) -> float:
    return float(
        np.arctan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y**2 + q.z**2))
    )


def _megabytes() -> float:
    """Memory of the process [MB]."""
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


def change_minds(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Changes its mind for some ``minutes``, or until a fall.

    Returns:
        What was done how often, refusals, and how much the process has grown after the
        first minute [MB]; 0 if the run is no longer than that.
    """
    mind = Mind(sim, sim.scenario.seed)
    memory, last = None, "none"
    while sim.time < 60.0 * float(parameters["minutes"]) and not sim.has_fallen:
        last = mind.change()
        if memory is None and sim.time >= 60.0:
            memory = _megabytes()
    return {
        "last_act": last,
        "refusals": sum(event.kind == "refusal" for event in sim.events),
        "memory_growth_mb": 0.0 if memory is None else _megabytes() - memory,
        **{f"acts: {name}": count for name, count in mind.done.items()},
    }
