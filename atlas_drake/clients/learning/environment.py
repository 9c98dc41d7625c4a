"""A Gymnasium environment: the simulation, a policy's observation, an action."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from atlas_drake.clients.learning.actions import Action
from atlas_drake.clients.policies.description import ObservationTerm, PolicyDescription
from atlas_drake.clients.policies.observation import Term
from atlas_drake.clients.policies.policy_joints import (
    History,
    PolicyJoints,
    observation_of,
)
from atlas_drake.clients.policies.reading import terms_of
from atlas_drake.clients.session import AtlasSimulation
from atlas_drake.config import checked
from atlas_drake.records import TickRecord
from atlas_drake.robot import load_robot
from atlas_drake.scenario import Scenario

PERIOD = 0.02
"""Usual time between two actions [s]."""
DURATION = 10.0
"""Usual length of an episode [s]."""
LARGEST_SEED = 2**31
"""Seeds of the runs are below."""


class AtlasEnv(gymnasium.Env[np.ndarray, np.ndarray]):
    """One robot that somebody learns to command.

    What a policy observes and commands is as with ``PolicyUser``: what is learned here
    with ``JointTargets`` runs there, see ``export``.

    Attributes:
        sim: The simulation.
        description: What observation and action mean, for ``export``.
        velocity: Desired velocity that ``velocity_commands`` observes, shape (3,).
    """

    metadata = {"render_modes": ["human"]}  # noqa: RUF012  # As Gymnasium has it.

    def __init__(
        self,
        scenario: Scenario | None = None,
        *,
        action: Action,
        observation: Sequence[str | Mapping[str, Any] | ObservationTerm],
        reward: Callable[[TickRecord], float],
        begin: Callable[[AtlasSimulation, np.random.Generator], object] | None = None,
        action_scale: float = 0.25,
        period: float = PERIOD,
        duration: float = DURATION,
        terms: Mapping[str, Term] | None = None,
        render_mode: str | None = None,
        **arguments: Any,
    ):
        """Builds the simulation.

        Args:
            scenario: Robot and world; its jitter and noise are drawn anew for each
                episode.
            action: What an action does, one of ``actions``.
            observation: Names of the terms, or terms with scale and history, see
                ``policies.observation.TERMS``.
            reward: Of a control tick's record, called after each action.
            begin: Called with the simulation and a random generator when an episode
                has begun, for instance to push the robot.
            action_scale: Set-point from the default position per unit of an action of
                ``JointTargets`` [rad].
            period: Time between two actions [s].
            duration: Of an episode [s].
            terms: Terms of your own, by name.
            render_mode: ``human`` opens the 3D view.
            **arguments: Further ones of ``AtlasSimulation``.

        Raises:
            ScenarioError: If a term or a joint is unknown, or a value cannot be used.
        """
        scenario = scenario or Scenario()
        robot = load_robot(scenario.model)
        names = action.joints(robot)
        indices = [robot.joint_index(name) for name in names]
        self.description: PolicyDescription = checked(
            PolicyDescription,
            {
                "network": "",
                "joints": list(names),
                "position": robot.stand_prep[indices],
                "kp": robot.default_kp[indices],
                "kd": robot.default_kd[indices],
                "action_scale": [action_scale],
                "period": period,
                "observation": [_term(one) for one in observation],
            },
        )
        functions, sizes = terms_of(self.description, terms)
        self._joints = PolicyJoints(self.description, robot, functions)
        self._action_of, self._reward, self._begin = action, reward, begin
        self._duration, self.render_mode = duration, render_mode
        self.velocity = np.zeros(3)
        self.sim = AtlasSimulation(
            scenario, **{"view": render_mode == "human", **arguments}
        )
        number = action.size(robot)
        self.action_space = spaces.Box(-1.0, 1.0, (number,), np.float32)
        self.observation_space = spaces.Box(-np.inf, np.inf, (sum(sizes),), np.float32)
        # The term ``actions`` is for a policy that commands all of its joints.
        self._last = np.zeros(len(names))
        self._seen: History = ()
        self._actions = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begins an episode: a run whose seed follows from this one, or from the last.

        Returns:
            The observation, and the facts of ``step``.
        """
        super().reset(seed=seed)
        self.sim.reset(seed=int(self.np_random.integers(LARGEST_SEED)))
        self._last, self._seen, self._actions = np.zeros_like(self._last), (), 0
        if self._begin is not None:
            self._begin(self.sim, self.np_random)
        return self._observe(), self._facts()

    def step(
        self, action: np.ndarray
    ) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Commands an action, and simulates until the next one.

        Returns:
            Observation, reward, whether the robot fell, whether time is up, and facts:
            the ``time`` of the run [s] and the ``behavior``.
        """
        given = np.asarray(action, dtype=float)
        if len(given) == len(self._last):
            self._last = given
        self._action_of.act(self.sim, self._joints, given, self.description.period)
        self._actions += 1
        return (
            self._observe(),
            float(self._reward(self.sim.record)),
            self.sim.has_fallen,
            self.sim.time >= self._duration - 1e-9,
            self._facts(),
        )

    def render(self) -> None:
        """Draws nothing more: the 3D view follows by itself."""

    def close(self) -> None:
        """Ends the simulation."""
        self.sim.close()

    def _observe(self) -> np.ndarray:
        sim = self.sim
        self._seen = self._joints.see(
            sim.atlas_state,
            sim.imu,
            self._last,
            self.velocity,
            self._actions,
            self._seen,
        )
        return observation_of(self._seen).astype(np.float32)

    def _facts(self) -> dict[str, Any]:
        return {"time": self.sim.time, "behavior": self.sim.current_behavior.name}


def _term(given: str | Mapping[str, Any] | ObservationTerm) -> Any:
    return {"name": given, "scale": [1.0]} if isinstance(given, str) else given
