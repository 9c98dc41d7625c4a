"""Frozen values: a changed copy leaves the original unchanged, and copies are cheap."""

import copy
import dataclasses
import importlib
import pkgutil
from dataclasses import dataclass
from functools import cached_property

import pytest

from atlas_drake import behaviors, control, messages, systems
from atlas_drake.frozen import Frozen, replace
from atlas_drake.messages import Message


@dataclass(frozen=True)
class Value(Frozen):
    """Something with two fields."""

    a: int
    b: str = "b"

    @cached_property
    def twice(self) -> int:
        return 2 * self.a


def test_a_changed_value_is_what_the_standard_library_makes_of_it():
    value = Value(1)
    assert value.twice == 2
    assert replace(value, a=2) == dataclasses.replace(value, a=2)
    assert replace(value, a=2).twice == 4
    assert value == Value(1) == replace(value)
    assert copy.deepcopy(value) is value
    with pytest.raises(TypeError, match="c"):
        replace(value, c=2)


@pytest.mark.parametrize("package", [behaviors, control, messages, systems])
def test_dataclasses_of_state_are_frozen_or_messages(package):
    places = pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
    modules = [importlib.import_module(place.name) for place in places]
    kinds = {
        kind
        for module in modules
        for kind in vars(module).values()
        if isinstance(kind, type)
        and dataclasses.is_dataclass(kind)
        and kind.__module__ == module.__name__
    }
    assert kinds
    for kind in kinds:
        if issubclass(kind, Message):
            # Comparison is the message's own, and misspelt fields are errors.
            assert "__slots__" in vars(kind), kind
            assert kind.__eq__ is Message.__eq__, kind
        else:
            assert kind.__dataclass_params__.frozen, kind
