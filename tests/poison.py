"""Invalid values that a script may assign to a field by mistake."""

import numpy as np

from atlas_drake.messages import AtlasCommand


def _list_within_itself():
    values = []
    values.extend([values] * 28)
    return values


def _nested_too_deep():
    values = [0.0] * 28
    for _ in range(5000):
        values = [values, *[0.0] * 27]
    return values


def _message_within_itself():
    message = AtlasCommand()
    message.header = message
    return message


class _Unspeakable:
    def __repr__(self):
        raise RuntimeError

    def __eq__(self, other):
        raise RuntimeError

    __hash__ = None


POISON = {
    "durations": lambda: np.zeros(28, dtype="timedelta64[s]"),
    "list of durations": lambda: [np.timedelta64(0, "s")] * 28,
    "dates": lambda: np.zeros(28, dtype="datetime64[s]"),
    "generator": lambda: (0.0 for _ in range(28)),
    "dict view": lambda: dict.fromkeys(range(28)).keys(),
    "memoryview": lambda: memoryview(bytes(28)),
    "list within itself": _list_within_itself,
    "nested too deep": _nested_too_deep,
    "message within itself": _message_within_itself,
    "masked array": lambda: np.ma.array(np.zeros(28), mask=[True] + [False] * 27),
    "400 digits": lambda: [10**400] * 28,
    "5000 digits": lambda: [10**5000] * 28,
    "unspeakable": lambda: [_Unspeakable()] * 28,
    "not a number": lambda: [float("nan")] * 28,
    "array of objects": lambda: np.array([object()] * 28),
}
"""Functions that make them, each time anew, by name."""
