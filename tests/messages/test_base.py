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


@pytest.mark.parametrize("kind", KINDS)
def test_every_message_is_comparable_independent_picklable_and_freezable(kind):
    message = kind()
    assert message == kind() == pickle.loads(pickle.dumps(message))
    for name in kind.__dataclass_fields__:
        value = getattr(message, name)
        if isinstance(value, (list, Message)):
            assert value is not getattr(kind(), name)
    with pytest.raises(TypeError, match="unhashable"):
        hash(message)
    with pytest.raises(AttributeError, match=f"{kind.__name__} has no field 'zzz'"):
        message.zzz = 1
    frozen = pickle.loads(pickle.dumps(kind().freeze()))
    assert frozen.is_frozen
    assert frozen == message


def test_arrays_have_the_scalar_of_a_quaternion_first_and_their_own_length():
    quaternion = Quaternion.from_wxyz(np.array([0.5, 0.1, 0.2, 0.3]))
    assert quaternion == Quaternion(x=0.1, y=0.2, z=0.3, w=0.5)
    np.testing.assert_array_equal(quaternion.to_wxyz(), [0.5, 0.1, 0.2, 0.3])
    assert Vector3.from_array([1, 2, 3]) == Vector3(1.0, 2.0, 3.0)
    assert Vector3(1.0, 2.0, 3.0).to_array().tolist() == [1.0, 2.0, 3.0]
    for kind in (Vector3.from_array, Quaternion.from_wxyz):
        with pytest.raises(ValueError, match="unpack"):
            kind([1.0, 2.0])


@pytest.mark.parametrize("other", [(1.0, 2.0), np.array([1.0, 2.0]), [1, 2]])
def test_sequences_compare_by_element(other):
    assert AtlasCommand(position=[1.0, 2.0]) == AtlasCommand(position=other)
    assert AtlasCommand(position=other) == AtlasCommand(position=[1.0, 2.0])
    assert AtlasCommand(position=other) != AtlasCommand(position=[1.0, 3.0])
    assert AtlasCommand(position=other) != AtlasCommand(position=[1.0])


@pytest.mark.parametrize("value", [np.array(2.0), None, "text", [[1.0], [2.0, 3.0]]])
def test_comparison_is_true_or_false_for_any_value_of_a_field(value):
    odd = AtlasCommand(position=value)
    assert (odd == AtlasCommand(position=value)) is True
    assert (odd == AtlasCommand(position=np.array([1.0, 2.0]))) is False
    assert (odd == Vector3()) is False


def test_comparison_reaches_into_nested_messages_and_a_nan_equals_a_nan():
    a, b = AtlasSimInterfaceCommand(), AtlasSimInterfaceCommand()
    a.walk_params.step_queue[3].pose.position.z = float("nan")
    b.walk_params.step_queue[3].pose.position.z = float("nan")
    assert a == b
    b.walk_params.step_queue[3].pose.position.z = 1e-9
    assert a != b


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


def test_a_deep_copy_is_independent_and_keeps_sharing():
    command = AtlasCommand(position=[0.1, 0.2, 0.3])
    command.effort = command.position
    twin = copy.deepcopy(command)
    twin.position[0] = 9.0
    assert twin.effort[0] == 9.0
    assert command.position[0] == 0.1


def test_messages_do_not_load_drake():
    code = (
        "import sys, atlas_drake.messages;"
        "sys.exit(any(name.split('.')[0] == 'pydrake' for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
