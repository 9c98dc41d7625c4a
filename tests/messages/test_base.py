"""Properties of all messages: misspelt fields, comparison, freezing, pickling."""

import copy
import pickle
import subprocess
import sys
from dataclasses import is_dataclass, replace

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

KINDS = [
    kind
    for kind in (getattr(messages, name) for name in messages.__all__)
    if is_dataclass(kind) and issubclass(kind, Message)
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
    with pytest.raises(AttributeError, match="no field"):
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


def test_a_frozen_message_does_not_change_and_is_its_own_copy():
    frozen = AtlasSimInterfaceCommand().freeze()
    assert frozen.freeze() is frozen
    assert copy.deepcopy(frozen) is frozen
    with pytest.raises(AttributeError, match="frozen"):
        frozen.position = []
    with pytest.raises(AttributeError, match="frozen"):
        frozen.walk_params.step_queue[1].pose.position.x = 1.0
    with pytest.raises(TypeError):
        frozen.walk_params.step_queue[1] = None
    changed = replace(frozen, behavior="WALK")
    changed.behavior = "STEP"
    assert frozen == AtlasSimInterfaceCommand()


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
    frozen = pickle.loads(pickle.dumps(kind().freeze()))
    assert frozen == kind()
    assert frozen.is_frozen


def test_messages_do_not_load_drake():
    code = (
        "import sys, atlas_drake.messages;"
        "sys.exit(any(name.split('.')[0] == 'pydrake' for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
