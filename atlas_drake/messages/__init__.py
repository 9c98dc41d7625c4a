"""Messages of the Atlas control interface: commands to the robot and its reports.

Data and validation only, with numpy and the standard library; no Drake, no control.
"""

from atlas_drake.messages.atlas_command import AtlasCommand
from atlas_drake.messages.atlas_sim_interface_command import AtlasSimInterfaceCommand
from atlas_drake.messages.atlas_sim_interface_state import (
    AtlasPositionData,
    AtlasSimInterfaceState,
)
from atlas_drake.messages.atlas_state import AtlasState
from atlas_drake.messages.base import Message
from atlas_drake.messages.behavior import Behavior
from atlas_drake.messages.behavior_feedback import (
    AtlasBehaviorFeedback,
    AtlasBehaviorManipulateFeedback,
    AtlasBehaviorStandFeedback,
    AtlasBehaviorStepFeedback,
    AtlasBehaviorWalkFeedback,
    BehaviorStatus,
    StepStatus,
    WalkStatus,
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
    ToeOff,
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
from atlas_drake.messages.imu import Imu

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
