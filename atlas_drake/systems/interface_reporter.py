"""The state message of the control interface, for any controller.

The controller's own values are in its status; efforts, shares and poses are read from
ports.
"""

from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from atlas_drake.frozen import NOTHING
from atlas_drake.messages import (
    AtlasSimInterfaceState,
    Header,
    Pose,
    Quaternion,
    Vector3,
)
from atlas_drake.messages.atlas_sim_interface_state import AtlasPositionData
from atlas_drake.messages.commands import CommandsInForce
from atlas_drake.messages.controller_status import REPORTED
from atlas_drake.messages.reported_status import reported_status
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.scratch import declare_scratch_context


class InterfaceReporter(CollectableSystem):
    """Status, efforts, commands and measured state in, the interface's message out.

    Input ports:
        state: Measured positions and velocities, in plant order.
        behavior_effort: Efforts of the controller [N·m], shape (n,).
        controller_status: ``ControllerStatus``
        commands: ``CommandsInForce``

    Output ports:
        atlas_sim_interface_state: ``AtlasSimInterfaceState``
    """

    __slots__ = ()

    def __init__(self, robot: Robot):
        """Reports on ``robot``."""
        super().__init__()
        self._plant: Any = robot.make_plant()
        self._pelvis = robot.indices(self._plant).pelvis
        self._soles = [
            self._plant.GetFrameByName(foot.sole_frame).index()
            for foot in robot.file.feet
        ]
        self._state = self.DeclareVectorInputPort(
            "state", self._plant.num_multibody_states()
        )
        self._effort = self.DeclareVectorInputPort("behavior_effort", robot.num_joints)
        self._status, self._commands = (
            self.DeclareAbstractInputPort(name, AbstractValue.Make(NOTHING))
            for name in ("controller_status", "commands")
        )
        self._scratch = declare_scratch_context(self, self._plant.CreateDefaultContext)
        self.DeclareAbstractOutputPort(
            "atlas_sim_interface_state",
            lambda: AbstractValue.Make(AtlasSimInterfaceState()),
            self._calc_report,
        )

    def _calc_report(self, context: Context, output: AbstractValue) -> None:
        commands: CommandsInForce = self._commands.Eval(context)
        status = reported_status(self._status.Eval(context), commands)
        state = self._state.Eval(context)
        # All at once: an empty message first would make every part twice.
        output.set_value(
            AtlasSimInterfaceState(
                header=Header(context.get_time()),
                f_out=self._effort.Eval(context).tolist(),
                pos_est=AtlasPositionData(
                    Vector3.from_array(state[self._pelvis.position]),
                    Vector3.from_array(state[self._pelvis.velocity]),
                ),
                foot_pos_est=self._sole_poses(context, state),
                k_effort=commands.k_effort.astype(int).tolist(),
                **{name: getattr(status, name) for name in REPORTED},
            )
        )

    def _sole_poses(self, context: Context, state: np.ndarray) -> list[Pose]:
        scratch = self._scratch.Eval(context)
        self._plant.SetPositions(scratch, state[: self._plant.num_positions()])
        return [
            _pose(self._plant.get_frame(index).CalcPoseInWorld(scratch))
            for index in self._soles
        ]


def _pose(X_WF: RigidTransform) -> Pose:
    quaternion = X_WF.rotation().ToQuaternion()
    return Pose(
        position=Vector3.from_array(X_WF.translation()),
        orientation=Quaternion.from_wxyz(quaternion.wxyz()),
    )
