"""The noise of a sensor as a parameter in its Context, so that each run has a seed."""

from typing import Any

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from atlas_drake.scenario.noise import SensorNoise
from atlas_drake.systems.collectable_system import CollectableSystem


class NoisySystem(CollectableSystem):
    """A system that adds noise to its measurements."""

    __slots__ = ()

    def declare_noise(self, noise: SensorNoise) -> None:
        """Declares the parameter, with the noise of the default context."""
        self._noise_index = self.DeclareAbstractParameter(AbstractValue.Make(noise))

    def set_seed(self, context: Context, seed: int) -> None:
        """Draws the noise from another seed from now on.

        Args:
            context: Context of this system.
            seed: The seed, from 0 to 2**64 - 1.
        """
        parameter: Any = context.get_mutable_abstract_parameter(self._noise_index)
        parameter.set_value(self.noise(context).with_seed(seed))

    def noise(self, context: Context) -> SensorNoise:
        """Returns the noise in force."""
        parameter: Any = context.get_abstract_parameter(self._noise_index)
        return parameter.get_value()
