"""Messages of ROS: what they are made of, and what becomes of them."""

import copy

import numpy as np
import pytest

from atlas_drake import messages as ours
from atlas_drake.clients.ros_scripts.message_types import (
    ROS_TYPES,
    atlas_msgs,
    from_ours,
    to_ours,
)
from atlas_drake.clients.ros_scripts.ros_message import Duration, Time
from atlas_drake.clients.ros_scripts.ros_types import geometry_msgs, std_msgs
from atlas_drake.clients.ros_scripts.unknown import UnknownNameError

Command, Walk, State = (
    atlas_msgs[f"Atlas{name}"]
    for name in ("Command", "SimInterfaceCommand", "SimInterfaceState")
)


@pytest.mark.parametrize("kind", ROS_TYPES, ids=lambda kind: kind.__name__)
def test_messages_survive_the_way_there_and_back(kind, filled):
    message = filled(kind)
    assert to_ours(from_ours(message), kind) == message
    empty = ROS_TYPES[kind]()
    assert copy.deepcopy(empty) == empty
    if kind in (ours.AtlasCommand, ours.AtlasSimInterfaceCommand):
        assert to_ours(empty, kind) == kind()


def test_fields_begin_at_zero_as_in_ros():
    message = Walk()
    assert len(message.walk_params.step_queue) == 4
    step = message.walk_params.step_queue[0]
    assert (step.step_index, step.pose.orientation.w) == (0, 0.0)
    assert message.header.stamp == Time(0)
    assert Walk.WALK == message.WALK == 4
    assert message.walk_params.step_queue[1] is not step


def test_misspelt_fields_are_named():
    message = Walk()
    with pytest.raises(UnknownNameError, match=r"behavor.*Did you mean 'behavior'"):
        message.behavor = 3
    with pytest.raises(AttributeError, match="k_efort"):
        _ = message.k_efort
    with pytest.raises(UnknownNameError, match="field foo of geometry_msgs/Point"):
        geometry_msgs["Point"](foo=1.0)
    with pytest.raises(TypeError, match="geometry_msgs/Point"):
        geometry_msgs["Point"](1.0, 2.0)
    message.walk_params.step_queue[2] = geometry_msgs["Pose"](None, None)
    with pytest.raises(UnknownNameError, match="step_index of geometry_msgs/Pose"):
        to_ours(message, ours.AtlasSimInterfaceCommand)


@pytest.mark.parametrize(
    "k_effort",
    [
        [255] * 28,
        (255,) * 28,
        b"\xff" * 28,
        bytearray([255] * 28),
        "".join(chr(255) for _ in range(28)),
        np.full(28, 255),
    ],
    ids=lambda value: type(value).__name__,
)
def test_bytes_come_in_every_form_that_programs_used(k_effort):
    message = Command(k_effort=k_effort)
    assert list(to_ours(message, ours.AtlasCommand).k_effort) == [255] * 28


def test_a_stamp_is_seconds_in_ours():
    message = Command()
    message.header.stamp = Time(3, 500_000_000)
    assert to_ours(message, ours.AtlasCommand).header.stamp == 3.5


def test_messages_print_as_yaml():
    state = atlas_msgs["AtlasState"]()
    assert str(state).splitlines()[:3] == ["header:", "  seq: 0", "  stamp: Time[0]"]
    assert str(std_msgs["String"]("so")) == "data: 'so'"


def test_times_are_seconds_and_nanoseconds():
    time, span = Time(1.5), Duration(2, 500_000_000)
    assert (time + span).to_sec() == 4.0
    assert time - span == Time(-1)
    assert (Time(4) - Time(1.5)).to_sec() == 2.5
    assert Duration(0.3) * 2 == Duration(0.6)
    assert span / Duration(0.5) == 5.0
    assert (time < Time(2), time >= Time(1.5), Duration(-1) < span) == (True,) * 3
    assert (time.secs, time.nsecs, time.to_nsec()) == (1, 500_000_000, 1_500_000_000)
    with pytest.raises(TypeError):
        _ = time < 2.0


@pytest.mark.parametrize(
    ("read", "now"),
    [
        (lambda: Walk().manipulate_params.desired.pelvis_lat, "com_v0"),
        (lambda: Walk().walk_params.step_data, "step_queue"),
        (lambda: State().behavior_feedback.walk_feedback, "State.walk_feedback"),
        (lambda: State().foot_pose_est, "foot_pos_est"),
    ],
)
def test_fields_of_older_messages_are_named_as_they_are_today(read, now):
    with pytest.raises(AttributeError, match=f"Its name is now .*{now}"):
        read()


def test_values_by_position_are_those_of_the_original():
    step = atlas_msgs["AtlasBehaviorStepData"]()
    params = atlas_msgs["AtlasBehaviorStepParams"](step, True)
    assert (params.desired_step, params.use_demo_walk) == (step, True)
    queue = [step] * 4
    assert atlas_msgs["AtlasBehaviorWalkParams"](queue, False).step_queue == queue
