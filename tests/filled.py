"""Messages with another number in each field."""

import itertools

from atlas_drake.messages import Message


def filled(kind):
    """A message of a kind whose numbers all differ."""
    numbers = itertools.count(2)

    def other(value):
        if isinstance(value, list):
            return [next(numbers) % 256 for _ in range(28)]
        if isinstance(value, bool):
            return True
        return type(value + 0)(next(numbers))

    return changed(kind(), other)


def changed(message, other):
    """The message, each of its lists without messages and its numbers replaced."""
    for name in message.__dataclass_fields__:
        value = getattr(message, name)
        if isinstance(value, Message):
            changed(value, other)
        elif isinstance(value, list) and value:
            [changed(part, other) for part in value]
        elif isinstance(value, (list, int, float)):
            setattr(message, name, other(value))
    return message
