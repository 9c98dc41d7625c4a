"""The state message of the control interface, for any controller.

The controller's own values are in its status; efforts, shares and poses are read from
ports.
"""

from dataclasses import fields
from typing import Any

from pydrake.common.value import AbstractValue
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from atlas_drake.errors import ErrorCode
from atlas_drake.frozen import NOTHING
from atlas_drake.messages import (
    AtlasBehaviorFeedback,
    AtlasBehaviorManipulateFeedback,
    AtlasBehaviorStandFeedback,
    AtlasBehaviorStepFeedback,
    AtlasBehaviorWalkFeedback,
    AtlasSimInterfaceState,
    BehaviorStatus,
    Header,
    Pose,
    Quaternion,
    Vector3,
)
from atlas_drake.messages.atlas_sim_interface_state import AtlasPositionData
from atlas_drake.messages.commands import ActiveCommand
from atlas_drake.messages.controller_status import ControllerStatus
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem

_BLANK = AtlasSimInterfaceState().freeze()
_PARTS = {field.name: getattr(_BLANK, field.name) for field in fields(_BLANK)}
"""Blank parts that all reports share; making them takes longer than the rest."""
_FEEDBACK = {
    AtlasBehaviorStandFeedback: "stand_feedback",
    AtlasBehaviorStepFeedback: "step_feedback",
    AtlasBehaviorWalkFeedback: "walk_feedback",
    AtlasBehaviorManipulateFeedback: "manipulate_feedback",
}
"""Fields of the behaviors' feedback messages; other values are in ``feedback``."""


def behavior_report(
    status: ControllerStatus, commands: ActiveCommand
) -> AtlasSimInterfaceState:
    """Returns the report as far as the controller knows it; nothing is measured.

    The errors of refused messages, which never reach the controller, are added.

    Args:
        status: Status of the controller.
        commands: The commands in force.
    """
    transition = status.behavior_feedback
    if commands.error_code is ErrorCode.NO_SUCH_BEHAVIOR:
        transition = AtlasBehaviorFeedback(
            transition.status_flags | BehaviorStatus.FAILED_TRANS_UNKNOWN_BEHAVIOR,
            transition.trans_from,
            transition.trans_to,
        )
    # Otherwise the last message is not the controller's last request.
    reached = commands.received == commands.request.number
    return AtlasSimInterfaceState(
        **{
            **_PARTS,
            "current_behavior": status.current_behavior,
            "desired_behavior": status.desired_behavior,
            "error_code": status.error_code if reached else commands.error_code,
            "behavior_feedback": transition,
            _FEEDBACK.get(type(status.feedback), "feedback"): status.feedback,
        }
    )


class InterfaceReporter(CollectableSystem):
    """Status, efforts, commands and measured state in, the interface's message out.

    Input ports:
        state: Measured positions and velocities, in plant order.
        behavior_effort: Efforts of the controller [N·m], shape (n,).
        controller_status: ``ControllerStatus``
        commands: ``ActiveCommand``

    Output ports:
        atlas_sim_interface_state: ``AtlasSimInterfaceState``
    """

    __slots__ = ()

    def __init__(self, robot: Robot):
        """Reports on ``robot``."""
        super().__init__()
        self._plant: Any = robot.make_plant()
        self._pelvis = robot.indices(self._plant).pelvis
        self._soles = robot.soles(self._plant)
        self._state = self.DeclareVectorInputPort(
            "state", self._plant.num_multibody_states()
        )
        self._effort = self.DeclareVectorInputPort("behavior_effort", robot.num_joints)
        self._status, self._commands = (
            self.DeclareAbstractInputPort(name, AbstractValue.Make(NOTHING))
            for name in ("controller_status", "commands")
        )
        self._scratch = self.declare_scratch_context(self._plant.CreateDefaultContext)
        self.DeclareAbstractOutputPort(
            "atlas_sim_interface_state",
            lambda: AbstractValue.Make(AtlasSimInterfaceState()),
            self._calc_report,
        )

    def _calc_report(self, context: Context, output: AbstractValue) -> None:
        commands: ActiveCommand = self._commands.Eval(context)
        state = self._state.Eval(context)
        report = behavior_report(self._status.Eval(context), commands)
        report.header = Header(context.get_time())
        report.f_out = self._effort.Eval(context).tolist()
        report.pos_est = AtlasPositionData(
            Vector3.from_array(state[self._pelvis.position]),
            Vector3.from_array(state[self._pelvis.velocity]),
        )
        scratch = self._scratch.Eval(context)
        self._plant.SetPositions(scratch, state[: self._plant.num_positions()])
        report.foot_pos_est = [
            _pose(self._plant.get_frame(index).CalcPoseInWorld(scratch))
            for index in self._soles
        ]
        report.k_effort = commands.k_effort.astype(int).tolist()
        output.set_value(report)


def _pose(X_WF: RigidTransform) -> Pose:
    quaternion = X_WF.rotation().ToQuaternion()
    return Pose(
        position=Vector3.from_array(X_WF.translation()),
        orientation=Quaternion.from_wxyz(quaternion.wxyz()),
    )
