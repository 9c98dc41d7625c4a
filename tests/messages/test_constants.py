"""Indices and bits against the figures of the control interface."""

from dataclasses import fields, is_dataclass

from atlas_drake import messages
from atlas_drake.errors import ErrorCode
from atlas_drake.messages import (
    NO_STEP,
    AtlasBehaviorFeedback,
    AtlasBehaviorStepFeedback,
    AtlasBehaviorWalkFeedback,
    AtlasSimInterfaceState,
    AtlasState,
    Message,
    ToeOff,
)

TRUNK = ["back_bkz", "back_bky", "back_bkx", "neck_ry"]
LEG = ["leg_hpz", "leg_hpx", "leg_hpy", "leg_kny", "leg_aky", "leg_akx"]
ARM = ["arm_shy", "arm_shx", "arm_ely", "arm_elx", "arm_wry", "arm_wrx"]
JOINTS = TRUNK + [
    f"{side}_{joint}" for limb in (LEG, ARM) for side in "lr" for joint in limb
]

FIRST_VERSION = {
    "back_lbz": "back_bkz",
    "back_mby": "back_bky",
    "back_ubx": "back_bkx",
    "neck_ay": "neck_ry",
}
FIRST_VERSION_OF_A_SIDE = {
    "leg_uhz": "leg_hpz",
    "leg_mhx": "leg_hpx",
    "leg_lhy": "leg_hpy",
    "leg_uay": "leg_aky",
    "leg_lax": "leg_akx",
    "arm_usy": "arm_shy",
    "arm_uwy": "arm_wry",
    "arm_mwx": "arm_wrx",
}


def test_joint_indices():
    assert len(JOINTS) == 28
    assert [getattr(AtlasState, joint) for joint in JOINTS] == list(range(28))
    assert AtlasState().r_arm_wrx == 27


def test_joint_aliases_of_the_first_version():
    aliases = dict(FIRST_VERSION)
    for side in "lr":
        for old, new in FIRST_VERSION_OF_A_SIDE.items():
            aliases[f"{side}_{old}"] = f"{side}_{new}"
    for old, new in aliases.items():
        assert getattr(AtlasState, old) == getattr(AtlasState, new), old


def test_error_codes():
    names = [
        "NO_ERRORS",
        "ERROR_UNSPECIFIED",
        "ERROR_VALUE_OUT_OF_RANGE",
        "ERROR_INVALID_INDEX",
        "ERROR_FAILED_TO_START_BEHAVIOR",
        "ERROR_NO_ACTIVE_BEHAVIOR",
        "ERROR_NO_SUCH_BEHAVIOR",
        "ERROR_BEHAVIOR_NOT_IMPLEMENTED",
        "ERROR_TIME_RAN_BACKWARD",
    ]
    codes = [getattr(AtlasSimInterfaceState, name) for name in names]
    assert codes == [0, -1, -2, -3, -4, -5, -6, -7, -8]
    assert codes == list(ErrorCode)


def test_transition_flags():
    names = [
        "TRANSITION_IN_PROGRESS",
        "TRANSITION_SUCCESS",
        "FAILED_TRANS_UNKNOWN_BEHAVIOR",
        "FAILED_TRANS_ILLEGAL_BEHAVIOR",
        "FAILED_TRANS_COM_POS",
        "FAILED_TRANS_COM_VEL",
        "FAILED_TRANS_VEL",
        "WARNING_AUTO_TRANS",
        "ERROR_FALLING",
    ]
    for bit, name in enumerate(names):
        assert getattr(AtlasBehaviorFeedback, f"STATUS_{name}") == 1 << bit
    assert AtlasBehaviorFeedback.STATUS_OK == 0


def test_walk_and_step_flags():
    walk = AtlasBehaviorWalkFeedback
    assert walk.WALK_OKAY == 0
    assert walk.WALK_SUBSTATE_SWAYING == 1
    assert walk.WALK_SUBSTATE_STEPPING == 2
    assert walk.WALK_SUBSTATE_CATCHING == 4
    assert walk.WALK_WARNING_INSUFFICIENT_STEP_DATA == 8
    assert walk.WALK_ERROR_INCONSISTENT_STEPS == 16
    step = AtlasBehaviorStepFeedback
    assert step.STEP_OKAY == 0
    assert step.STEP_SUBSTATE_SWAYING == 1
    assert step.STEP_SUBSTATE_STEPPING == 2


CUSTOMARY = {
    "Quaternion.w": 1.0,
    "AtlasBehaviorStepData.step_index": NO_STEP,
    "AtlasBehaviorStepSpec.step_index": NO_STEP,
    "AtlasBehaviorStepAction.step_duration": 0.7,
    "AtlasBehaviorStepAction.sway_duration": 0.1,
    "AtlasBehaviorStepAction.toe_off": ToeOff.ENABLE,
    "AtlasBehaviorStepAction.sway_end_dist": 0.1,
    "AtlasBehaviorStepAction.step_end_dist": 0.1,
    "AtlasBehaviorPelvisServoParams.pelvis_height": 0.8,
    "AtlasBehaviorWalkFeedback.next_step_index_needed": 1,
    "AtlasBehaviorStepFeedback.next_step_index_needed": 1,
}
"""Fields of an empty message that are not zero."""


def test_an_empty_message_is_zero_but_for_the_customary_values():
    kinds = [kind for kind in vars(messages).values() if is_dataclass(kind)]
    values = {
        f"{kind.__name__}.{field.name}": getattr(kind(), field.name)
        for kind in kinds
        if issubclass(kind, Message)
        for field in fields(kind)
    }
    numbers = {k: v for k, v in values.items() if isinstance(v, (int, float))}
    assert len(numbers) > 40
    assert {name: value for name, value in numbers.items() if value} == CUSTOMARY
