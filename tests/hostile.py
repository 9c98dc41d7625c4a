"""Commands with one value somewhere that must be refused, for property tests."""

from dataclasses import fields

import numpy as np
from hypothesis import strategies as st

from atlas_drake.messages import (
    AtlasBehaviorStepData,
    AtlasBehaviorStepSpec,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Message,
)

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
