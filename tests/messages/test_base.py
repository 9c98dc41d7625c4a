"""Properties of all messages: misspelt fields, comparison, snapshots, pickling."""

import copy
import pickle
import subprocess
import sys
from dataclasses import is_dataclass

import numpy as np
import pytest

from atlas_drake import messages
from atlas_drake.messages import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Message,
    Quaternion,
    Vector3,
)
from atlas_drake.messages.base import frozen, same_content
from atlas_drake.messages.plain import message_from

KINDS = [
    kind
    for kind in (getattr(messages, name) for name in messages.__all__)
    if is_dataclass(kind)
]


def filled_command():
    """Return a command with a list, an array and nested values."""
    command = AtlasCommand()
    command.header.stamp = 1.5
    command.position = [0.1, 0.2, 0.3]
    command.velocity = np.array([1.0, 2.0, 3.0])
    command.k_effort = [0, 255, 128]
    return command


@pytest.mark.parametrize("kind", KINDS)
def test_empty_messages_are_equal_and_independent(kind):
    assert kind() == kind()
    assert issubclass(kind, Message)
    with pytest.raises(TypeError, match="unhashable"):
        hash(kind())
    for name in kind.__dataclass_fields__:
        value = getattr(kind(), name)
        if isinstance(value, (list, Message)):
            assert value is not getattr(kind(), name)


def test_arrays_have_the_scalar_of_a_quaternion_first_and_their_own_length():
    quaternion = Quaternion.from_wxyz(np.array([0.5, 0.1, 0.2, 0.3]))
    assert quaternion == Quaternion(x=0.1, y=0.2, z=0.3, w=0.5)
    np.testing.assert_array_equal(quaternion.to_wxyz(), [0.5, 0.1, 0.2, 0.3])
    assert Vector3.from_array([1, 2, 3]) == Vector3(1.0, 2.0, 3.0)
    for kind in (Vector3.from_array, Quaternion.from_wxyz):
        with pytest.raises(ValueError, match="unpack"):
            kind([1.0, 2.0])


@pytest.mark.parametrize("kind", KINDS)
def test_unknown_field_is_an_error(kind):
    with pytest.raises(AttributeError, match=f"{kind.__name__} has no field 'zzz'"):
        kind().zzz = 1


def test_misspelt_field_gets_a_suggestion():
    with pytest.raises(AttributeError, match="Did you mean 'position'"):
        AtlasCommand().posiiton = [0.0]
    with pytest.raises(AttributeError, match="Did you mean 'use_demo_walk'"):
        AtlasSimInterfaceCommand().walk_params.use_demowalk = True
    with pytest.raises(TypeError, match="posiiton"):
        AtlasCommand(posiiton=[0.0])


def test_constants_and_fields_stay():
    command = AtlasSimInterfaceCommand()
    with pytest.raises(AttributeError, match="is a constant"):
        command.STAND = 3
    with pytest.raises(AttributeError, match="cannot be deleted"):
        del command.behavior
    assert command.behavior == command.NONE


@pytest.mark.parametrize("other", [(1.0, 2.0), np.array([1.0, 2.0]), [1, 2]])
def test_sequences_compare_by_element(other):
    assert AtlasCommand(position=[1.0, 2.0]) == AtlasCommand(position=other)
    assert AtlasCommand(position=other) == AtlasCommand(position=[1.0, 2.0])
    assert AtlasCommand(position=other) != AtlasCommand(position=[1.0, 3.0])
    assert AtlasCommand(position=other) != AtlasCommand(position=[1.0])


def test_comparison_reaches_into_nested_messages():
    a, b = AtlasSimInterfaceCommand(), AtlasSimInterfaceCommand()
    assert a == b
    b.walk_params.step_queue[3].pose.position.z = 1e-9
    assert a != b


@pytest.mark.parametrize(
    "value", [np.array(2.0), None, "text", [[1.0], [2.0, 3.0]], np.ones((2, 2))]
)
def test_comparison_is_true_or_false_for_any_value_of_a_field(value):
    odd = AtlasCommand(position=value)
    assert (odd == AtlasCommand(position=value)) is True
    assert (odd == AtlasCommand(position=np.array([1.0, 2.0]))) is False
    assert (odd == Vector3()) is False


def test_a_snapshot_neither_follows_its_original_nor_changes():
    command = filled_command()
    snapshot = command.snapshot()
    assert snapshot == command
    command.header.stamp = 9.0
    command.position[0] = 9.0
    command.velocity[0] = 9.0
    assert snapshot == filled_command()
    with pytest.raises(AttributeError, match="snapshot"):
        snapshot.position = []
    with pytest.raises(AttributeError, match="snapshot"):
        snapshot.header.stamp = 0.0
    with pytest.raises(TypeError):
        snapshot.position[0] = 9.0
    with pytest.raises(ValueError, match="read-only"):
        snapshot.velocity[0] = 9.0
    step = AtlasSimInterfaceCommand().snapshot().walk_params.step_queue[1]
    with pytest.raises(AttributeError, match="snapshot"):
        step.pose.position.x = 1.0


@pytest.mark.parametrize(
    ("value", "kind"),
    [
        (np.float64(1.0), float),
        (np.float64(np.inf), float),
        (np.float32(1.0), float),
        (np.int64(1), int),
        (np.bool_(1), bool),
        (True, bool),
    ],
)
def test_numbers_of_a_snapshot_are_pythons_own(value, kind):
    assert type(frozen(value)) is kind
    assert type(frozen([value])[0]) is kind
    assert same_content(value, frozen(value))


@pytest.mark.parametrize("flag", [True, np.True_])
def test_a_truth_value_is_not_the_content_of_a_number(flag):
    assert not same_content(flag, 1)
    assert not same_content(1, frozen(flag))
    assert not same_content([1.0, 1], frozen([1.0, flag]))
    assert not same_content([1.0, flag], (1.0, 1))
    assert not same_content(not flag, frozen(flag))
    assert not same_content(type(flag)(0), frozen(flag))
    assert same_content([1.0, 1], (1, 1.0))


def test_arrays_differ_in_shape_and_type():
    values = np.array([1.0, 2.0])
    assert same_content(values, frozen(values))
    for other in (values[:, np.newaxis], values.view(int), values + 1.0, [1.0, 2.0]):
        assert not same_content(values, frozen(other))


def test_a_snapshot_is_its_own_copy_and_its_mutable_copy_may_change():
    snapshot = filled_command().snapshot()
    assert snapshot.snapshot() is snapshot
    assert copy.deepcopy(snapshot) is snapshot
    thawed = snapshot.mutable_copy()
    thawed.header.stamp = 9.0
    thawed.position[0] = 9.0
    thawed.velocity[0] = 9.0
    assert snapshot == filled_command()
    assert thawed.position == [9.0, 0.2, 0.3]


def test_deep_copy_is_independent_and_keeps_sharing():
    command = filled_command()
    command.effort = command.position
    twin = copy.deepcopy(command)
    twin.position[0] = 9.0
    assert twin.effort[0] == 9.0
    assert command.position[0] == 0.1


@pytest.mark.parametrize("kind", KINDS)
def test_pickling_keeps_messages(kind):
    assert pickle.loads(pickle.dumps(kind())) == kind()
    frozen = pickle.loads(pickle.dumps(kind().snapshot()))
    assert frozen == kind()
    assert frozen.snapshot() is frozen


def test_pickling_keeps_arrays_of_a_snapshot_read_only():
    frozen = pickle.loads(pickle.dumps(filled_command().snapshot()))
    assert frozen == filled_command()
    assert not frozen.velocity.flags.writeable
    thawed = pickle.loads(pickle.dumps(filled_command()))
    thawed.velocity[0] = 9.0
    assert thawed.velocity[0] == 9.0


def test_messages_do_not_load_drake():
    code = (
        "import sys, atlas_drake.messages;"
        "sys.exit(any(name.split('.')[0] == 'pydrake' for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_unknown_fields_are_dropped_and_known_ones_kept_unless_strict():
    plain = {"unheard_of": 3, "behavior": "WALK", "k_effort": [1, 2]}
    kept = message_from(AtlasSimInterfaceCommand, plain, strict=False)
    assert (kept.behavior, list(kept.k_effort)) == ("WALK", [1, 2])
