"""YAML as users write it, and the checks of what is read."""

import dataclasses
import types
import typing
from typing import Annotated

import numpy as np
import pytest
from annotated_types import Len, Unit
from hypothesis import given
from hypothesis import strategies as st
from pydrake.common.yaml import yaml_dump

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.clients.campaigns import load_campaign
from atlas_drake.clients.campaigns.campaign import Campaign, Threshold
from atlas_drake.config import (
    MAX_VALUES,
    Configuration,
    LeastGreatest,
    Positive,
    Range,
    as_plain,
    checked,
    fields_of,
    read_yaml,
    trailing_strings,
)
from atlas_drake.errors import AtlasError, ScenarioError
from atlas_drake.robot import RobotFile, load_robot
from atlas_drake.scenario import Scenario, load_scenario, with_settings
from atlas_drake.units import Meters, unit_of
from atlas_drake.worlds.world_file import World, load_world

LEAVES = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False)
    | st.text("aNe-.:#'\" ", max_size=5)
)
VALUES = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner) | st.dictionaries(st.sampled_from("xyz"), inner),
    max_leaves=8,
)


@given(st.dictionaries(st.sampled_from("abc"), VALUES))
def test_what_was_written_is_read(value):
    assert read_yaml(yaml_dump(value)) == value


@given(st.floats(1e-9, 1e9))
def test_a_number_may_have_an_exponent_without_a_point(number):
    digits, exponent = f"{number:e}".split("e")
    short = f"{round(float(digits))}e{int(exponent)}"
    assert read_yaml(f"a: [{number:e}, {short}]") == {
        "a": [float(f"{number:e}"), float(short)]
    }


def test_parts_for_aliases_and_tags_are_read_as_drake_reads_them():
    text = "_part: &part {deg: [0, 0, 90]}\na: !Rpy {<<: *part}\nb: *part\n"
    assert read_yaml(text) == {
        "a": {"deg": [0, 0, 90], "_tag": "!Rpy"},
        "b": {"deg": [0, 0, 90]},
    }
    # What is merged may be given anew.
    assert read_yaml("a: &a {x: 1}\nb: {<<: *a, x: 2}")["b"] == {"x": 2}
    assert read_yaml("") is None


LAUGHS = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]\n" for k in range(1, 12)
)
FAULTS = {
    "duration: 1\nname: x\nduration: 2\n": ("line 3", "duration", "twice"),
    "start:\n  {yaw: 1, yaw: 2}\n": ("line 2", "yaw", "twice"),
    "pushes: [{time: 1,\n time: 2}]": ("line 2", "time", "twice"),
    "name: x\n1: 2\n": ("line 2", "key 1", "no text"),
    "start: {true: 2}\n": ("line 1", "key true", "no text"),
    "? [1, 2]\n: 3\n": ("line 1", "no text"),
    "a: 1\nb: &all\n  - {c: *all}\n": ("line 3", "*all", "within"),
    "a: &a {<<: *a}\n": ("line 1", "*a", "within"),
    LAUGHS: (str(MAX_VALUES), "values"),
    "a: 1\nb: [\n": ("line 3",),
    "a: *none\n": ("line 1", "none"),
    "a: \x00": ("special characters",),
    "[" * 500: ("nested",),
}


@pytest.mark.parametrize("text", FAULTS, ids=range(len(FAULTS)))
@pytest.mark.parametrize("load", [load_scenario, load_world, load_robot, load_campaign])
def test_a_faulty_file_is_refused_in_one_line(load, text, tmp_path):
    path = tmp_path / "faulty.yaml"
    path.write_text(text)
    with pytest.raises(AtlasError) as error:
        load(path)
    said = str(error.value)
    assert "\n" not in said
    assert all(words in said for words in (str(path), *FAULTS[text]))


@pytest.mark.parametrize("value", ["&all [*all]", "{a: 1, a: 2}", "{1: 2}", "["])
def test_a_faulty_setting_is_refused_in_one_line(value):
    with pytest.raises(ScenarioError) as error:
        with_settings(Scenario(), [f"terrain={value}"])
    assert error.value.field == "terrain"
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("load", [load_scenario, load_world, load_robot])
@pytest.mark.parametrize("text", ["", "- duration\n", "3", "\xff"])
def test_a_file_without_fields_is_refused(load, text, tmp_path):
    path = tmp_path / "empty.yaml"
    path.write_text(text, encoding="latin-1")
    with pytest.raises(AtlasError) as error:
        load(path)
    assert error.value.field == "file"
    assert str(path) in str(error.value)


@dataclasses.dataclass(frozen=True)
class Inner(Configuration):
    """A part with a default of its own."""

    size: Positive[Meters] = 1.0
    """How large."""
    reach: Annotated[Range, Unit("rad")] = LeastGreatest(0.0, 1.0)
    """From where to where."""


@dataclasses.dataclass(frozen=True)
class Outer(Configuration):
    """A whole."""

    inner: Inner = dataclasses.field(default_factory=lambda: Inner(size=3.0))
    parts: list[Inner] = dataclasses.field(default_factory=list)
    ends: Annotated[list[int], Len(2, 2)] | None = None
    on: bool = False

    def check(self) -> None:
        """Refuses a whole that is too small."""
        if self.inner.size < 2.0:
            raise ScenarioError.about("inner.size", self.inner.size, "is too small")


def test_fields_left_out_have_the_defaults_of_their_place():
    made = checked(Outer, {"inner": {"reach": [0, 2]}, "parts": [{}]})
    assert made.inner == Inner(3.0, (0.0, 2.0))
    assert made.parts == [Inner(1.0, (0.0, 1.0))]
    assert checked(Outer, {"on": True}, base=made) == dataclasses.replace(made, on=True)
    assert checked(Outer, as_plain(made)) == made


def test_numpys_numbers_and_arrays_become_pythons():
    given = Outer(Inner(np.float32(2.5)), ends=np.array([1, 2]), on=np.bool_(True))
    made = checked(Outer, given)
    assert made == Outer(Inner(2.5, (0.0, 1.0)), [], [1, 2], on=True)
    assert (type(made.inner.size), type(made.ends[0]), type(made.on)) == (
        float,
        int,
        bool,
    )


@pytest.mark.parametrize(
    ("fields", "field", "words"),
    [
        ({"inner": {"size": -1}}, "inner.size", "is -1 m; must be greater than 0"),
        ({"inner": {"size": "1"}}, "inner.size", "is '1'"),
        ({"inner": {"size": True}}, "inner.size", "is True"),
        ({"inner": {"size": 10**400}}, "inner.size", "must be"),
        ({"inner": {"size": 1e7}}, "inner.size", "within"),
        ({"inner": {"size": float("nan")}}, "inner.size", "finite"),
        ({"inner": {"size": 1.0}}, "inner.size", "too small"),
        ({"inner": {"sise": 1.0}}, "inner.sise", "Did you mean 'size'"),
        ({"inner": {"way": 1.0}}, "inner.way", "size, reach"),
        ({"inner": 3}, "inner", "Inner"),
        ({"inner": {"reach": 3}}, "inner.reach", "is 3"),
        ({"inner": {"reach": [1, 0]}}, "inner.reach", "exceed"),
        ({"inner": {"reach": [1]}}, "inner.reach[1]", "missing"),
        ({"inner": {"reach": ["0", 1]}}, "inner.reach[0]", "is '0'"),
        ({"parts": [{}, {"size": 0}]}, "parts[1].size", "is 0 m"),
        ({"parts": {}}, "parts", "list"),
        ({"ends": [1]}, "ends", "at least 2"),
        ({"ends": [1, 2.5]}, "ends[1]", "is 2.5"),
        ({"on": 1}, "on", "boolean"),
        ([], "at", "Outer"),
    ],
)
def test_what_cannot_be_used_is_named_with_its_value(fields, field, words):
    with pytest.raises(ScenarioError) as error:
        checked(Outer, fields, "at")
    assert error.value.field == ("at" if field == "at" else f"at.{field}")
    assert words in error.value.problem


def test_the_text_of_a_field_stands_below_it():
    assert trailing_strings(Inner) == {
        "size": "How large.",
        "reach": "From where to where.",
    }
    assert trailing_strings(types.SimpleNamespace) == {}  # Has no source in Python.


def configurations(cls=Configuration):
    """The package's dataclasses that files are read into."""
    for kind in cls.__subclasses__():
        yield from configurations(kind)
        if dataclasses.is_dataclass(kind) and kind.__module__.startswith("atlas_drake"):
            yield kind


def has_number(kind):
    return kind is float or any(map(has_number, typing.get_args(kind)))


def test_every_number_has_a_unit():
    kinds = set(configurations()) - {Threshold}  # Its unit is that of what it searches.
    assert {ControllerConfig, Scenario, World, RobotFile, Campaign} <= kinds
    for kind in kinds:
        for name, annotation in fields_of(kind).items():
            if has_number(annotation):
                assert unit_of(annotation), f"{kind.__name__}.{name} has no unit"
