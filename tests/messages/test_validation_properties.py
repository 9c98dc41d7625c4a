"""Any message is either valid, or refused with one error that names the field."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages import (
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Pose,
    Quaternion,
    Vector3,
    check_command,
)
from atlas_drake.messages.checks import LARGEST

JOINTS = ["neck", "knee", "wrist"]
SETPOINTS = ["position", "velocity", "effort", "i_effort_min", "i_effort_max"]
GAINS = ["kp_position", "ki_position", "kd_position", "kp_velocity"]

anything = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.complex_numbers(),
    st.text(max_size=3),
    st.lists(st.one_of(st.floats(), st.text(max_size=2), st.none()), max_size=5),
    st.builds(Vector3),
)


def outcome(message):
    """Return the error that a message raises, or None."""
    try:
        check_command(message, JOINTS)
    except InvalidMessageError as error:
        return error
    return None


@settings(max_examples=50)
@given(name=st.sampled_from(SETPOINTS + GAINS + ["k_effort"]), value=anything)
def test_any_value_of_an_array_gives_an_error_of_that_array_or_none(name, value):
    error = outcome(AtlasCommand(**{name: value}))
    good = isinstance(value, list) and (
        not value
        or (
            len(value) == len(JOINTS)
            and all(isinstance(x, float) and abs(x) <= LARGEST for x in value)
        )
    )
    if not good:
        assert error is not None
    elif name in SETPOINTS:
        assert error is None
    if error is not None:
        assert error.field.split("[")[0] == name


finite = st.floats(-LARGEST, LARGEST)
fields_of_steps = st.one_of(anything, st.sampled_from([0, 1, -1, 2, 0.63]))


@settings(max_examples=100)
@given(
    step=st.builds(
        AtlasBehaviorStepData,
        step_index=st.one_of(st.integers(-2, 9), anything),
        foot_index=st.one_of(st.integers(0, 1), anything),
        duration=st.one_of(finite, anything),
        swing_height=st.one_of(finite, anything),
        pose=st.builds(
            Pose,
            position=st.builds(Vector3, finite, finite, fields_of_steps),
            orientation=st.builds(Quaternion, finite, finite, finite, fields_of_steps),
        ),
    ),
    place=st.integers(0, 3),
)
def test_any_step_is_usable_or_refused_by_its_place(step, place):
    command = AtlasSimInterfaceCommand(behavior="walk")
    command.walk_params.step_queue[place] = step
    error = outcome(command)
    if error is not None:
        assert error.field.startswith(f"walk_params.step_queue[{place}].")
    elif step.step_index != -1:
        assert step.step_index >= 1
        assert step.foot_index in (0, 1)
        assert 0.0 < step.duration < math.inf
        assert 0.0 <= step.swing_height < math.inf
        assert np.isfinite(step.pose.position.to_array()).all()
        assert np.abs(step.pose.orientation.to_wxyz()).max() > 0.0
