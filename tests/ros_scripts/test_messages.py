"""Messages of ROS: what they are made of, and what becomes of them."""

import copy

import numpy as np
import pytest

from atlas_drake import messages as ours
from atlas_drake.ros_scripts.conversion import from_ours, to_ours
from atlas_drake.ros_scripts.message_types import (
    ROS_TYPES,
    atlas_msgs,
    geometry_msgs,
    std_msgs,
)
from atlas_drake.ros_scripts.ros_time import Duration, Time
from atlas_drake.ros_scripts.unknown import ScriptError, UnknownNameError

Command, Walk = atlas_msgs["AtlasCommand"], atlas_msgs["AtlasSimInterfaceCommand"]


@pytest.mark.parametrize("kind", ROS_TYPES, ids=lambda kind: kind.__name__)
def test_every_field_survives_the_way_there_and_back(kind, filled):
    message = filled(kind)
    assert to_ours(from_ours(message), kind) == message


@pytest.mark.parametrize("kind", ROS_TYPES, ids=lambda kind: kind.__name__)
def test_an_empty_ros_message_becomes_our_empty_message(kind):
    ros = ROS_TYPES[kind]()
    if kind in (ours.AtlasCommand, ours.AtlasSimInterfaceCommand):
        assert to_ours(ros, kind) == kind()
    assert ros == type(ros)()
    assert copy.deepcopy(ros) == ros


def test_fields_begin_at_zero_as_in_ros():
    message = Walk()
    assert len(message.walk_params.step_queue) == 4
    step = message.walk_params.step_queue[0]
    assert (step.step_index, step.pose.orientation.w) == (0, 0.0)
    assert message.header.stamp == Time(0)
    assert Walk.WALK == message.WALK == 4
    assert atlas_msgs["AtlasState"].r_arm_wrx == 27
    assert message.walk_params.step_queue[1] is not step


def test_misspelt_fields_are_named():
    message = Walk()
    with pytest.raises(UnknownNameError, match=r"behavor.*Did you mean 'behavior'"):
        message.behavor = 3
    with pytest.raises(AttributeError, match="Did you mean 'k_effort'"):
        _ = message.k_efort
    with pytest.raises(UnknownNameError, match="field foo of geometry_msgs/Point"):
        geometry_msgs["Point"](foo=1.0)
    with pytest.raises(TypeError, match="takes 3 values"):
        geometry_msgs["Point"](1.0, 2.0)


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


def test_a_nested_message_of_another_type_is_named():
    message = Walk()
    message.walk_params.step_queue[2] = geometry_msgs["Pose"]()
    with pytest.raises(ScriptError, match=r"walk_params.step_queue\[2\] must be"):
        to_ours(message, ours.AtlasSimInterfaceCommand)


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
    assert (time < Time(2), time >= Time(1.5), -span < Duration(0)) == (True,) * 3
    assert (time == span, bool(Time())) == (False, False)
    assert (time.secs, time.nsecs, time.to_nsec()) == (1, 500_000_000, 1_500_000_000)
    with pytest.raises(TypeError):
        _ = time < 2.0
