"""The door refuses any fault by name, and gives what it accepts one frozen form."""

import copy
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from atlas_drake.errors import ErrorCode, InvalidMessageError
from atlas_drake.frozen import NOTHING
from atlas_drake.messages import (
    NO_STEP,
    Accepted,
    AtlasBehaviorStepData,
    AtlasBehaviorStepSpec,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Behavior,
    Header,
    Message,
    Refusal,
    accept,
)
from atlas_drake.messages.behavior_catalog import (
    SHIPPED,
    BehaviorCatalog,
    BehaviorInterface,
)
from atlas_drake.messages.checks import check_number, check_vector
from atlas_drake.messages.commands import commands_at_start, merge_ports
from atlas_drake.robot import load_robot

ROBOT = load_robot()
KINDS = [AtlasCommand, AtlasSimInterfaceCommand]
START = commands_at_start(ROBOT, Behavior.STAND)

# ---- messages with one value that must be refused ----------------------------

NEVER_NEGATIVE = ("stamp", "duration", "swing_height", "max_body_accel", "max_foot_vel")
"""Fields with a number that is at least 0, some of them in some messages only."""


def _list_within_itself():
    values = []
    values.extend([values] * 28)
    return values


class _Unspeakable:
    def __repr__(self):
        raise RuntimeError

    def __eq__(self, other):
        raise RuntimeError

    __hash__ = None


POISON = {
    "durations": lambda: np.zeros(28, dtype="timedelta64[s]"),
    "generator": lambda: (0.0 for _ in range(28)),
    "list within itself": _list_within_itself,
    "400 digits": lambda: [10**400] * 28,
    "5000 digits": lambda: [10**5000] * 28,
    "unspeakable": lambda: [_Unspeakable()] * 28,
    "not a number": lambda: [float("nan")] * 28,
    "array of objects": lambda: np.array([object()] * 28),
}
"""Functions that make what no field of a message can hold, each time anew, by name."""

nonsense = st.one_of(
    st.complex_numbers(),
    st.text(min_size=1, max_size=3),
    st.sampled_from([float("nan"), float("inf"), -float("inf"), 10**400, 1e13]),
    st.builds(object),
    st.builds(dict),
    st.sampled_from(list(POISON.values())).map(lambda make: make()),
)
"""What no field of a command can hold, but for a text in the fields of texts."""
not_of_one_number = st.one_of(nonsense, st.booleans(), st.none())


def filled_command(kind):
    """A valid command in which every field is read."""
    if kind is AtlasCommand:
        return AtlasCommand(k_effort=[7] * 28)
    command = AtlasSimInterfaceCommand(behavior="STAND", k_effort=[7] * 28)
    for place in range(4):
        step = AtlasBehaviorStepData(place + 1, place % 2, 0.63)
        command.walk_params.step_queue[place] = step
    command.step_params.desired_step = AtlasBehaviorStepData(1, 0, 0.63)
    command.step_params.desired_step_spec = AtlasBehaviorStepSpec(1)
    return command


def paths(message, prefix=""):
    """Paths of all fields of a message and of those within, with their values."""
    for field in fields(message):
        path, value = f"{prefix}{field.name}", getattr(message, field.name)
        yield path, value
        if isinstance(value, Message):
            yield from paths(value, f"{path}.")
        for place, part in enumerate(value if isinstance(value, list) else ()):
            if isinstance(part, Message):
                yield f"{path}[{place}]", part
                yield from paths(part, f"{path}[{place}].")


def put(message, path, value):
    """Sets what a path from the message leads to."""
    *way, name = path.replace("[", ".").replace("]", "").split(".")
    for part in way:
        message = message[int(part)] if part.isdigit() else getattr(message, part)
    if name.isdigit():
        message[int(name)] = value
    else:
        setattr(message, name, value)


def wrong_values(path, value):
    """Values that the field must not hold, whose valid value is given."""
    name = path.rpartition(".")[-1]
    if name == "params":
        return st.one_of(nonsense, st.booleans())
    if name == "frame_id":
        return not_of_one_number.filter(lambda one: not isinstance(one, str))
    if name == "stamp":
        return st.one_of(nonsense, st.booleans(), st.just(-1.0))
    if isinstance(value, Message) or name.endswith("step_queue"):
        return st.one_of(not_of_one_number, st.just([value] * 5))
    if isinstance(value, list):
        return wrong_arrays(name)
    if isinstance(value, bool):
        return st.one_of(nonsense, st.sampled_from([None, 2, 0.5]))
    if name in ("behavior", "step_index", "foot_index", "toe_off") or "period" in name:
        return st.one_of(not_of_one_number, st.sampled_from([-7, 300**4, 0.5]))
    if name in NEVER_NEGATIVE and "action.swing_height" not in path:
        return st.one_of(not_of_one_number, st.just(-1e-9))
    return not_of_one_number


def wrong_arrays(name):
    """Joint arrays with a fault: a kind, a length, one element."""
    wrong_element = st.one_of(
        not_of_one_number,
        st.just(-1e-9) if name.startswith("k") else st.nothing(),
        st.sampled_from([256, 0.5]) if name == "k_effort" else st.nothing(),
    )
    return st.one_of(
        not_of_one_number,
        st.integers(1, 60).filter(lambda n: n != 28).map(lambda n: [0.0] * n),
        st.tuples(st.integers(0, 27), wrong_element).map(
            lambda pick: [*[0] * pick[0], pick[1], *[0] * (27 - pick[0])]
        ),
        st.sampled_from([np.full(28, np.nan), np.zeros((28, 1)), np.array(1.0)]),
        st.sampled_from([np.array([True] * 28), np.array(["a"] * 28)]),
    )


@st.composite
def spoiled_commands(draw):
    """A command and the path of the only value in it that must be refused."""
    kind = draw(st.sampled_from([AtlasCommand, AtlasSimInterfaceCommand]))
    command = filled_command(kind)
    path, value = draw(st.sampled_from(list(paths(command))))
    put(command, path, draw(wrong_values(path, value)))
    return command, path


# ---- the door ----------------------------------------------------------------


def accepted(message):
    outcome = accept(message, ROBOT)
    assert isinstance(outcome, Accepted), outcome
    return outcome


def refusal(message):
    outcome = accept(message, ROBOT)
    assert isinstance(outcome, Refusal), outcome
    return outcome


@pytest.mark.slow
@settings(
    max_examples=200,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(spoiled_commands())
def test_any_wrong_value_is_refused_once_by_name_and_changes_nothing(spoiled):
    command, path = spoiled
    outcome = refusal(command)
    assert outcome.field.startswith(path)
    assert outcome.error_code != ErrorCode.NO_ERRORS
    assert len(str(outcome.error)) < 1000
    ports = (
        [command, NOTHING] if isinstance(command, AtlasCommand) else [NOTHING, command]
    )
    force = merge_ports(START, ports, ROBOT, 1.0)
    assert force.refused == force.received == 1
    assert (force.joints, force.request) == (START.joints, START.request)
    # It stays on its port.
    assert merge_ports(force, ports, ROBOT, 2.0) is force


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_accepted_has_one_form_and_never_changes(kind):
    command = filled_command(kind)
    arrays = [path for path, value in paths(command) if value == []]
    outcomes = []
    for number, make in enumerate((list, tuple, np.array, np.float32)):
        for path in arrays:
            put(command, path, make([0.0, 1.0] * 14))
        command.k_effort = make([0, 255] * 14)
        command.header.stamp = (1, 1.0, np.float64(1.0), np.int16(1))[number]
        outcomes.append(accepted(command))
        assert outcomes[-1] == outcomes[0] == accepted(copy.deepcopy(command))
    last = outcomes[-1]
    assert last.message.k_effort == (0, 255) * 14
    assert {type(number) for number in last.message.k_effort} == {int}
    assert {type(number) for number in last.message.position} == {float}
    assert last.joints["position"].tolist() == [0.0, 1.0] * 14
    assert accept(last.message, ROBOT) == last
    for path, value in paths(last.message):
        assert not isinstance(value, list | np.ndarray | np.generic), path
        with pytest.raises(AttributeError, match="frozen"):
            put(last.message, path, value)
    with pytest.raises(ValueError, match="read-only"):
        last.joints["position"][0] = 1.0


@pytest.mark.parametrize("kind", KINDS)
def test_an_empty_message_is_valid(kind):
    assert accepted(kind()).joints == {}
    assert accepted(kind(position=np.zeros(0))).joints == {}
    assert accepted(kind(header=Header(None))).message.header.stamp is None


@pytest.mark.parametrize(
    ("fields", "field"),
    [
        ({"kp_position": [1.0, *[-1.0] * 27]}, "kp_position[1]"),
        (
            {"i_effort_min": [0.0] * 28, "i_effort_max": [0.0, -1.0, *[0.0] * 26]},
            "i_effort_min[1]",
        ),
    ],
)
def test_a_bad_element_is_named_with_its_joint(fields, field):
    outcome = refusal(AtlasCommand(**fields))
    assert outcome.field == field
    assert ROBOT.joint_names[1] in outcome.problem


def test_directions_have_a_length():
    for path, value in (
        ("walk_params.step_queue[0].pose.orientation", "w"),
        ("step_params.desired_step.pose.orientation", "w"),
        ("step_params.desired_step_spec.foot.normal", "z"),
    ):
        command = filled_command(AtlasSimInterfaceCommand)
        put(command, f"{path}.{value}", 1e-9)
        assert refusal(command).field == path
        put(command, f"{path}.{value}", 0.3)
        accepted(command)


def test_of_an_empty_step_nothing_is_read():
    command = filled_command(AtlasSimInterfaceCommand)
    empty = AtlasBehaviorStepData(step_index=NO_STEP, foot_index=7, duration=-1.0)
    command.walk_params.step_queue[3] = empty
    spec = command.step_params.desired_step_spec
    spec.step_index, spec.foot_index, spec.foot.yaw = NO_STEP, 9, float("nan")
    made = accepted(command).message
    assert made.walk_params.step_queue[3] == AtlasBehaviorStepData()


def test_a_home_step_and_repeated_steps_request_nothing():
    command = filled_command(AtlasSimInterfaceCommand)
    queue = command.walk_params.step_queue
    # Teleoperation programs leave all else of it at zero.
    home = AtlasBehaviorStepData(step_index=0)
    home.pose.orientation.w = 0.0
    queue[1].step_index, queue[2].step_index = 1, 2
    command.walk_params.step_queue = [home, queue[1], queue[2], queue[2]]
    made = accepted(command).message.walk_params.step_queue
    empty = AtlasBehaviorStepData()
    assert list(made) == [empty, queue[1], queue[2], empty]


@pytest.mark.parametrize("indices", [(1, 1, 2, 3), (2, 1, 3, 4), (1, 2, 4, 3)])
def test_step_indices_must_increase(indices):
    command = filled_command(AtlasSimInterfaceCommand)
    queue = command.walk_params.step_queue
    for step, index in zip(queue, indices, strict=True):
        step.step_index = index
    outcome = refusal(command)
    place = next(i for i in range(1, 4) if indices[i] <= indices[i - 1])
    assert outcome.field == f"walk_params.step_queue[{place}].step_index"
    assert outcome.error_code is ErrorCode.INVALID_INDEX
    for step in queue:
        step.step_index = np.int64(20 + queue.index(step))
    accepted(command)


def test_codes_tell_indices_behaviors_and_values_apart():
    for path, value, code in (
        ("walk_params.step_queue[2].step_index", -2, ErrorCode.INVALID_INDEX),
        ("step_params.desired_step.foot_index", 2, ErrorCode.INVALID_INDEX),
        ("behavior", "stroll", ErrorCode.NO_SUCH_BEHAVIOR),
        ("stand_params", None, ErrorCode.VALUE_OUT_OF_RANGE),
    ):
        command = filled_command(AtlasSimInterfaceCommand)
        put(command, path, value)
        outcome = refusal(command)
        assert (outcome.field, outcome.error_code) == (path, code)
        assert outcome.error.value == value


def test_values_below_their_threshold_and_flags_of_any_type_are_taken():
    command = filled_command(AtlasSimInterfaceCommand)
    action = command.step_params.desired_step_spec.action
    action.toe_off = np.int32(2)
    action.sway_duration = action.swing_height = action.knee_nominal = -1.0
    action.sway_end_dist = 7.0
    for flag in (True, 1, np.True_):
        command.manipulate_params.use_desired = flag
        assert accepted(command).message.manipulate_params.use_desired is True


def test_any_other_value_is_no_message():
    for thing in (None, 5, "STAND", [1.0], {"behavior": 3}, Header(), object()):
        assert refusal(thing).field == "message"
    outcome = accept(AtlasCommand(), ROBOT, kind=AtlasSimInterfaceCommand)
    assert isinstance(outcome, Refusal)


@dataclass
class Anything:
    """Parameters of a behavior of one's own."""

    value: Any


@pytest.mark.parametrize("poison", POISON)
def test_parameters_of_a_users_behavior_are_refused_or_compared(poison):
    bow = BehaviorInterface(name="BOW", number=100, params=Anything)
    catalog = BehaviorCatalog((*SHIPPED, bow))

    def outcome():
        params = Anything(POISON[poison]())
        message = AtlasSimInterfaceCommand(behavior="BOW", params=params)
        return accept(message, ROBOT, catalog)

    # What stays on a port is no news, whether it can be used or not.
    assert outcome() == outcome()
    if poison in ("unspeakable", "generator", "list within itself"):
        assert outcome().field == "params"


@pytest.mark.parametrize(
    ("check", "given", "limit", "is_sound"),
    [
        (check_number, 2.0, {"lower": 2.0}, True),
        (check_number, np.int64(2), {"upper": 2.0, "whole": True}, True),
        (check_number, 2.1, {"upper": 2.0}, False),
        (check_number, 1.9, {"lower": 2.0}, False),
        (check_number, 2.5, {"whole": True}, False),
        (check_number, 2e12, {}, False),
        (check_number, True, {}, False),
        (check_number, "2", {}, False),
        (check_number, float("nan"), {}, False),
        (check_vector, (1, np.float32(-2.0)), {"size": 2, "largest": 2.0}, True),
        (check_vector, np.array([1.0, 2.1]), {"size": 2, "largest": 2.0}, False),
        (check_vector, [1.0], {"size": 2}, False),
        (check_vector, [1.0, None], {"size": 2}, False),
        (check_vector, "12", {"size": 2}, False),
    ],
)
def test_an_argument_of_a_call_is_returned_or_refused_by_name(
    check, given, limit, is_sound
):
    if is_sound:
        result = check(given, "name", **limit)
        assert result is None or np.array_equal(result, given)
    else:
        with pytest.raises(InvalidMessageError, match="name"):
            check(given, "name", **limit)
