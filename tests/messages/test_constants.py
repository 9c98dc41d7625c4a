"""Indices, bits and defaults against the figures of the control interface."""

from dataclasses import fields, is_dataclass

import pytest

from atlas_drake import messages
from atlas_drake.errors import ErrorCode

TRUNK = "back_bkz back_bky back_bkx neck_ry"
LEG = "leg_hpz leg_hpx leg_hpy leg_kny leg_aky leg_akx"
ARM = "arm_shy arm_shx arm_ely arm_elx arm_wry arm_wrx"
FIRST_TRUNK = "back_lbz back_mby back_ubx neck_ay"
FIRST_LEG = "leg_uhz leg_mhx leg_lhy leg_kny leg_uay leg_lax"
FIRST_ARM = "arm_usy arm_shx arm_ely arm_elx arm_uwy arm_mwx"


def names(trunk, leg, arm):
    """Names of the 28 joints in order."""
    limbs = [f"{s}_{n}" for limb in (leg, arm) for s in "lr" for n in limb.split()]
    return [*trunk.split(), *limbs]


@pytest.mark.parametrize(
    "joints", [names(TRUNK, LEG, ARM), names(FIRST_TRUNK, FIRST_LEG, FIRST_ARM)]
)
def test_joint_indices(joints):
    assert [getattr(messages.AtlasState, joint) for joint in joints] == list(range(28))


@pytest.mark.parametrize(
    ("owner", "prefix", "kind", "values"),
    [
        (messages.AtlasSimInterfaceCommand, "", messages.Behavior, range(8)),
        (messages.AtlasSimInterfaceState, "", messages.Behavior, range(8)),
        (
            messages.AtlasBehaviorFeedback,
            "STATUS_",
            messages.BehaviorStatus,
            [1 << b for b in range(9)],
        ),
        (
            messages.AtlasBehaviorWalkFeedback,
            "WALK_",
            messages.WalkStatus,
            [1, 2, 4, 8, 16],
        ),
        (messages.AtlasBehaviorStepFeedback, "STEP_", messages.StepStatus, [1, 2]),
        (messages.AtlasBehaviorStepAction, "TOE_OFF_", messages.ToeOff, range(3)),
    ],
)
def test_messages_have_the_constants_of_the_interface(owner, prefix, kind, values):
    members = kind.__members__
    assert [member.value for member in members.values() if member or 0 in values] == [
        *values
    ]
    for name, member in members.items():
        assert getattr(owner, f"{prefix}{name}") is member


def test_error_codes():
    prefixed = [n if n == "NO_ERRORS" else f"ERROR_{n}" for n in ErrorCode.__members__]
    codes = [getattr(messages.AtlasSimInterfaceState, name) for name in prefixed]
    assert codes == [0, -1, -2, -3, -4, -5, -6, -7, -8]
    assert messages.AtlasSimInterfaceState.ERROR_TIME_RAN_BACKWARD == -8


CUSTOMARY = {
    "Quaternion.w": 1.0,
    "AtlasBehaviorStepData.step_index": messages.NO_STEP,
    "AtlasBehaviorStepSpec.step_index": messages.NO_STEP,
    "AtlasBehaviorStepAction.step_duration": 0.7,
    "AtlasBehaviorStepAction.sway_duration": 0.1,
    "AtlasBehaviorStepAction.toe_off": messages.ToeOff.ENABLE,
    "AtlasBehaviorStepAction.sway_end_dist": 0.1,
    "AtlasBehaviorStepAction.step_end_dist": 0.1,
    "AtlasBehaviorPelvisServoParams.pelvis_height": 0.8,
    "AtlasBehaviorWalkFeedback.next_step_index_needed": 1,
    "AtlasBehaviorStepFeedback.next_step_index_needed": 1,
}
"""Fields of an empty message that are not zero."""


def test_an_empty_message_is_zero_but_for_the_customary_values():
    values = {
        f"{kind.__name__}.{field.name}": getattr(kind(), field.name)
        for kind in vars(messages).values()
        if is_dataclass(kind) and issubclass(kind, messages.Message)
        for field in fields(kind)
    }
    numbers = {k: v for k, v in values.items() if isinstance(v, (int, float))}
    assert len(numbers) > 40
    assert {name: value for name, value in numbers.items() if value} == CUSTOMARY
