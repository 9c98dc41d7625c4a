"""Noise of sensors and motors, as data and as a pure function of seed and time.

The same seed and instant give the same noise, so that a run can be repeated and a
Context cloned without hidden random state.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from atlas_drake.config import Configuration, NotNegative
from atlas_drake.errors import shown
from atlas_drake.frozen import Frozen
from atlas_drake.units import (
    MetersPerSecondSquared,
    Radians,
    RadiansPerSecond,
    Ratio,
)


@dataclass(frozen=True)
class NoiseModel(Configuration):
    """Standard deviations and biases of measurements and efforts."""

    gyro: NotNegative[RadiansPerSecond] = 0.0
    """White noise of the angular velocity."""
    gyro_bias_mean: NotNegative[RadiansPerSecond] = 0.0
    """Mean size of the constant bias of the angular velocity."""
    gyro_bias_sigma: NotNegative[RadiansPerSecond] = 0.0
    """Spread of that size."""
    accelerometer: NotNegative[MetersPerSecondSquared] = 0.0
    """White noise of the specific force."""
    accelerometer_bias_mean: NotNegative[MetersPerSecondSquared] = 0.0
    """Mean size of the constant bias of the specific force."""
    accelerometer_bias_sigma: NotNegative[MetersPerSecondSquared] = 0.0
    """Spread of that size."""
    joint_position: NotNegative[Radians] = 0.0
    """White noise of the joint encoders."""
    joint_velocity: NotNegative[RadiansPerSecond] = 0.0
    """White noise of the joint velocities."""
    effort: NotNegative[Ratio] = 0.0
    """White noise of the behaviors' efforts at the motors, in the motors' limits."""


REFERENCE_IMU = {
    "gyro": 2.0e-4,
    "gyro_bias_mean": 7.5e-6,
    "gyro_bias_sigma": 8.0e-7,
    "accelerometer": 1.7e-2,
    "accelerometer_bias_mean": 0.1,
    "accelerometer_bias_sigma": 1.0e-3,
}
"""The IMU of the simulator that this project re-creates."""

NoiseName = Literal["none", "reference", "rough"]
NOISE_MODELS: dict[str, NoiseModel] = {
    "none": NoiseModel(),
    "reference": NoiseModel(**REFERENCE_IMU),
    "rough": NoiseModel(**REFERENCE_IMU, joint_position=2.0e-4, joint_velocity=2.0e-2),
}
"""Models by name: exact sensors, the reference IMU, and the reference IMU with noisy
encoders."""


def noise_model(given: NoiseModel | str) -> NoiseModel:
    """Returns the model of a name; anything but a text is returned as it is."""
    if isinstance(given, str) and given not in NOISE_MODELS:
        names = ", ".join(NOISE_MODELS)
        raise ValueError(f"is {shown(given)}; must be one of {names}, or fields")
    return NOISE_MODELS[given] if isinstance(given, str) else given


@dataclass(frozen=True)
class NoiseSample:
    """Noise of one set of measurements, and of the efforts in their limits."""

    angular_velocity: np.ndarray
    specific_force: np.ndarray
    joint_position: np.ndarray
    joint_velocity: np.ndarray
    effort: np.ndarray


class SensorNoise(Frozen):
    """Draws the noise of one robot. Immutable, so that a Context can hold it."""

    def __init__(self, model: NoiseModel, seed: int, num_joints: int, period: float):
        """Draws the biases; measurements are ``period`` [s] apart."""
        self._model = model
        self._seed = seed
        self._num_joints = num_joints
        self._period = period
        random = np.random.Generator(np.random.Philox(key=[seed, 0]))
        self._gyro_bias = _bias(random, model.gyro_bias_mean, model.gyro_bias_sigma)
        self._accelerometer_bias = _bias(
            random, model.accelerometer_bias_mean, model.accelerometer_bias_sigma
        )
        self.silent = model == NoiseModel()

    def with_seed(self, seed: int) -> "SensorNoise":
        """Returns the noise of another seed."""
        return SensorNoise(self._model, seed, self._num_joints, self._period)

    def sample(self, time: float) -> NoiseSample:
        """The noise at ``time`` [s]."""
        model, n = self._model, self._num_joints
        step = 1 + round(time / self._period)
        random = np.random.Generator(np.random.Philox(key=[self._seed, step]))
        white = random.standard_normal(6 + 3 * n)
        return NoiseSample(
            angular_velocity=self._gyro_bias + model.gyro * white[:3],
            specific_force=self._accelerometer_bias + model.accelerometer * white[3:6],
            joint_position=model.joint_position * white[6 : 6 + n],
            joint_velocity=model.joint_velocity * white[6 + n : 6 + 2 * n],
            effort=model.effort * white[6 + 2 * n :],
        )


def _bias(random: np.random.Generator, mean: float, sigma: float) -> np.ndarray:
    """A constant of random size and sign per axis, shape (3,)."""
    size = random.normal(mean, sigma, size=3)
    return size * random.choice([-1.0, 1.0], size=3)
