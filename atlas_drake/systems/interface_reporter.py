"""The state message of the control interface, for any controller.

The controller's own values are in its status; efforts, shares and poses are read from
ports.
"""

from dataclasses import fields
from typing import Any

from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from atlas_drake.errors import ErrorCode
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
from atlas_drake.messages.atlas_state import AtlasPositionData
from atlas_drake.messages.commands import ActiveCommand
from atlas_drake.messages.controller_status import ControllerStatus
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem

_BLANK = AtlasSimInterfaceState().freeze()
_PARTS = {field.name: getattr(_BLANK, field.name) for field in fields(_BLANK)}
"""Blank parts that all reports share; making them takes longer than the rest."""
FEEDBACK_FIELDS = {
    AtlasBehaviorStandFeedback: "stand",
    AtlasBehaviorStepFeedback: "step",
    AtlasBehaviorWalkFeedback: "walk",
    AtlasBehaviorManipulateFeedback: "manipulate",
}
"""Behaviors of the interface by the class of their feedback."""


def answer(
    status: ControllerStatus, error: ErrorCode, reached: bool
) -> tuple[AtlasBehaviorFeedback, ErrorCode]:
    """Returns the answer to the last message: result of the transition, and error.

    ``error`` is that of the last message, refused ones included; it is the controller's
    own if the message ``reached`` it as its last request.
    """
    transition = status.behavior_feedback
    if error == ErrorCode.NO_SUCH_BEHAVIOR:
        transition = AtlasBehaviorFeedback(
            transition.status_flags | BehaviorStatus.FAILED_TRANS_UNKNOWN_BEHAVIOR,
            transition.trans_from,
            transition.trans_to,
        )
    return transition, status.error_code if reached else error


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
        self._plant: Any = robot.plant
        self._pelvis = robot.indices(self._plant).pelvis
        self._soles = robot.soles(self._plant)
        self._state = self.DeclareVectorInputPort(
            "state", self._plant.num_multibody_states()
        )
        self._effort = self.DeclareVectorInputPort("behavior_effort", robot.num_joints)
        self._status = self.declare_value_input("controller_status")
        self._commands = self.declare_value_input("commands")
        self._scratch = self.declare_scratch_context(self._plant.CreateDefaultContext)
        self.declare_value_output("atlas_sim_interface_state", self._report)

    def _report(self, context: Context) -> AtlasSimInterfaceState:
        commands: ActiveCommand = self._commands.Eval(context)
        state = self._state.Eval(context)
        status: ControllerStatus = self._status.Eval(context)
        reached = commands.received == commands.request.number
        transition, error = answer(status, commands.error_code, reached)
        own = FEEDBACK_FIELDS.get(type(status.feedback))
        report = AtlasSimInterfaceState(
            **{
                **_PARTS,
                "current_behavior": status.current_behavior,
                "desired_behavior": status.desired_behavior,
                "error_code": error,
                "behavior_feedback": transition,
                f"{own}_feedback" if own else "feedback": status.feedback,
            }
        )
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
        return report


def _pose(X_WF: RigidTransform) -> Pose:
    quaternion = X_WF.rotation().ToQuaternion()
    return Pose(
        position=Vector3.from_array(X_WF.translation()),
        orientation=Quaternion.from_wxyz(quaternion.wxyz()),
    )
