"""Messages of the Atlas control interface: commands to the robot and its reports.

Data and validation only, with numpy and the standard library; no Drake, no control.
"""

from atlas_drake.messages.atlas_command import AtlasCommand, AtlasSimInterfaceCommand
from atlas_drake.messages.atlas_state import (
    AtlasPositionData,
    AtlasSimInterfaceState,
    AtlasState,
    Imu,
)
from atlas_drake.messages.base import Message
from atlas_drake.messages.behavior import (
    Behavior,
    BehaviorStatus,
    StepStatus,
    ToeOff,
    WalkStatus,
)
from atlas_drake.messages.behavior_feedback import (
    AtlasBehaviorFeedback,
    AtlasBehaviorManipulateFeedback,
    AtlasBehaviorStandFeedback,
    AtlasBehaviorStepFeedback,
    AtlasBehaviorWalkFeedback,
)
from atlas_drake.messages.behavior_params import (
    NO_STEP,
    NUM_REQUIRED_WALK_STEPS,
    AtlasBehaviorFootData,
    AtlasBehaviorManipulateParams,
    AtlasBehaviorPelvisServoParams,
    AtlasBehaviorStandParams,
    AtlasBehaviorStepAction,
    AtlasBehaviorStepData,
    AtlasBehaviorStepParams,
    AtlasBehaviorStepSpec,
    AtlasBehaviorWalkParams,
)
from atlas_drake.messages.door import Accepted, Refusal, accept
from atlas_drake.messages.fields import K_EFFORT_MAX
from atlas_drake.messages.geometry import (
    Header,
    Pose,
    Quaternion,
    Twist,
    Vector3,
    Wrench,
)

__all__ = [
    "K_EFFORT_MAX",
    "NO_STEP",
    "NUM_REQUIRED_WALK_STEPS",
    "Accepted",
    "AtlasBehaviorFeedback",
    "AtlasBehaviorFootData",
    "AtlasBehaviorManipulateFeedback",
    "AtlasBehaviorManipulateParams",
    "AtlasBehaviorPelvisServoParams",
    "AtlasBehaviorStandFeedback",
    "AtlasBehaviorStandParams",
    "AtlasBehaviorStepAction",
    "AtlasBehaviorStepData",
    "AtlasBehaviorStepFeedback",
    "AtlasBehaviorStepParams",
    "AtlasBehaviorStepSpec",
    "AtlasBehaviorWalkFeedback",
    "AtlasBehaviorWalkParams",
    "AtlasCommand",
    "AtlasPositionData",
    "AtlasSimInterfaceCommand",
    "AtlasSimInterfaceState",
    "AtlasState",
    "Behavior",
    "BehaviorStatus",
    "Header",
    "Imu",
    "Message",
    "Pose",
    "Quaternion",
    "Refusal",
    "StepStatus",
    "ToeOff",
    "Twist",
    "Vector3",
    "WalkStatus",
    "Wrench",
    "accept",
]
