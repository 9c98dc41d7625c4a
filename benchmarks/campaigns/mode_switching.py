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
from random_walks import feet_of, message_of, random_steps

from atlas_drake import (
    K_EFFORT_MAX,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
)
from atlas_drake.frozen import replace

PAUSE = (0.1, 3.0)
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
        """Makes one to four steps, from the present footholds, wherever they lead."""
        limits = self.sim.scenario.controller_config().walk.limits
        count = int(self.random.integers(1, 5))
        steps = random_steps(
            feet_of(self.sim), limits, self.random, count, closes=False
        )
        command = self._ask(Behavior.WALK)
        for place, step in enumerate(steps):
            command.walk_params.step_queue[place] = message_of(step)
        return command

    def walk(self) -> None:
        """A few steps, to the end."""
        self._stand()
        self.sim.publish(self._queue())
        self.sim.advance(0.1)
        self._until(lambda: self.sim.current_behavior is Behavior.STAND)

    def walk_and_stop(self) -> None:
        """A few steps, and STAND at any moment of them."""
        self._stand()
        self.sim.publish(self._queue())
        self.sim.advance(float(self.random.uniform(0.1, 3.0)))
        self._stand()

    def step(self) -> None:
        """One quasi-static step."""
        self._stand()
        limits = self.sim.scenario.controller_config().step.limits
        (step,) = random_steps(feet_of(self.sim), limits, self.random, 1, closes=False)
        command = self._ask(Behavior.STEP)
        command.step_params.desired_step = message_of(
            replace(step, duration=1.0, swing_height=0.1)
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
            wish.pelvis_yaw = float(random.uniform(-0.2, 0.2))
            wish.pelvis_pitch = float(random.uniform(-0.3, 0.5))
            wish.pelvis_roll = float(random.uniform(-0.3, 0.3))
            wish.com_v0 = float(random.uniform(-0.15, 0.15))
            wish.com_v1 = float(random.uniform(-0.07, 0.07))
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
