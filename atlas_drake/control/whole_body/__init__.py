"""The whole-body QP: model terms, tasks, contacts, constraints, solver.

Names that a user's own behavior needs are exported here; see ``WholeBodyCommand.plus``.
"""

from atlas_drake.control.whole_body.command import WholeBodyCommand
from atlas_drake.control.whole_body.constraints import (
    Block,
    Constraint,
    EffortBounds,
    TaskBounds,
)
from atlas_drake.control.whole_body.contact import Contact, ContactPatch
from atlas_drake.control.whole_body.contact_tasks import (
    ComTask,
    InternalContactTask,
    MomentTask,
)
from atlas_drake.control.whole_body.elimination import ReducedDynamics
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.control.whole_body.qp import WholeBodyQp, WholeBodySolution
from atlas_drake.control.whole_body.tasks import (
    FrameTask,
    OrientationTask,
    PositionTask,
    PostureTask,
    Task,
    TaskRows,
)
from atlas_drake.control.whole_body.terms import FrameTerms, WholeBodyTerms

__all__ = [
    "Block",
    "ComTask",
    "Constraint",
    "Contact",
    "ContactPatch",
    "EffortBounds",
    "FrameTask",
    "FrameTerms",
    "InternalContactTask",
    "MomentTask",
    "OrientationTask",
    "PositionTask",
    "PostureTask",
    "ReducedDynamics",
    "Task",
    "TaskBounds",
    "TaskRows",
    "WholeBodyCommand",
    "WholeBodyModel",
    "WholeBodyQp",
    "WholeBodySolution",
    "WholeBodyTerms",
]
