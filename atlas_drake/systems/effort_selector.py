"""Blends the user's and the behavior's efforts, joint by joint.

effort = k·user + (1 - k)·behavior with k = k_effort/255, within the effort limits.
"""

import numpy as np
from pydrake.systems.framework import Context

from atlas_drake.control.joints.blend import blend
from atlas_drake.messages.joint_command import share_of
from atlas_drake.robot import PlantIndices, Robot
from atlas_drake.systems.collectable_system import CollectableSystem


class EffortSelector(CollectableSystem):
    """The k_effort selector. It has no state.

    Input ports, shape (n,), message order:
        user_effort: Efforts of the user's law [N·m].
        behavior_effort: Efforts of the behavior [N·m].
        k_effort: The user's share, 0 to 255.

    Output ports:
        effort: Efforts of the motors [N·m], shape (n,), message order.
        actuation: The same efforts in the order of the plant's actuators.
    """

    __slots__ = ()

    def __init__(self, robot: Robot, indices: PlantIndices):
        """Blends for a plant with the given indices."""
        super().__init__()
        n = robot.num_joints
        self._limit = robot.effort_limit
        self._to_plant = np.argsort(indices.actuation)
        self._user = self.DeclareVectorInputPort("user_effort", n)
        self._behavior = self.DeclareVectorInputPort("behavior_effort", n)
        self._k_effort = self.DeclareVectorInputPort("k_effort", n)
        inputs = {self.all_input_ports_ticket()}
        self.declare_vector_output("effort", n, self._blend, inputs)
        self.declare_vector_output(
            "actuation",
            n,
            lambda context: self._blend(context).take(self._to_plant),
            inputs,
        )

    def _blend(self, context: Context) -> np.ndarray:
        k_effort = self._k_effort.Eval(context)
        behavior = self._behavior.Eval(context)
        # Without a user share the user's efforts need no evaluation, which saves time
        # at every physics step.
        user = self._user.Eval(context) if np.count_nonzero(k_effort) else behavior
        return blend(user, behavior, share_of(k_effort), self._limit)
