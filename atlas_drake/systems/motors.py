"""What lies between the behaviors' efforts and the motors: a delay, and noise."""

from typing import Any

import numpy as np
from pydrake.systems.framework import Context, State

from atlas_drake.frozen import NOTHING, read_only
from atlas_drake.robot import Robot
from atlas_drake.systems.imu import NoisySystem
from atlas_drake.systems.sensor_noise import NoiseModel, SensorNoise


class Motors(NoisySystem):
    """Efforts of the behaviors in, as the motors receive them out.

    A station has it only if a scenario asks for delay or noise. The first effort is
    received at once.

    Input ports:
        behavior_effort: Efforts of the behavior [N·m], shape (n,), message order.
        speed_hold: ``SpeedHold``, what the motors add to them, or ``NOTHING``;
            optional.

    Output ports:
        received_effort: The same, later and with noise that lasts for a control tick.
        received_hold: The same, later.

    State, updated at physics steps: what is on its way, the oldest first.
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        noise: NoiseModel,
        seed: int,
        delay: float,
        physics_step: float,
        control_period: float,
    ):
        """Delays the efforts by a multiple of the physics step; times in [s]."""
        super().__init__()
        n = robot.num_joints
        self._limit = robot.effort_limit
        self._steps = round(delay / physics_step)
        self.declare_noise(SensorNoise(noise, seed, n, control_period))
        self._effort = self.DeclareVectorInputPort("behavior_effort", n)
        self._hold = self.declare_value_input("speed_hold")
        self._on_the_way = self.declare_value_state(())
        self.declare_vector_output("received_effort", n, self._received_effort)
        self.declare_value_output(
            "received_hold", lambda context: self._received(context)[1]
        )
        if self._steps:
            self.DeclarePeriodicUnrestrictedUpdateEvent(physics_step, 0.0, self._send)

    def reset(self, context: Context) -> None:
        """Forgets the efforts on their way."""
        self._on_the_way.set(context, ())

    def _present(self, context: Context) -> tuple[np.ndarray, Any]:
        hold = self._hold
        return (
            self._effort.Eval(context),
            hold.Eval(context) if hold.HasValue(context) else NOTHING,
        )

    def _received(self, context: Context) -> tuple[np.ndarray, Any]:
        on_the_way = self._on_the_way.get(context)
        return on_the_way[0] if on_the_way else self._present(context)

    def _received_effort(self, context: Context) -> np.ndarray:
        effort, _ = self._received(context)
        noise = self.noise(context)
        if noise.silent:
            return effort
        return effort + self._limit * noise.sample(context.get_time()).effort

    def _send(self, context: Context, state: State) -> None:
        effort, hold = self._present(context)
        sent = read_only(effort.copy()), hold
        on_the_way = self._on_the_way.get(context) or (sent,) * self._steps
        self._on_the_way.set(state, (*on_the_way[1:], sent))
