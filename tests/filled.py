"""Messages with another number in each field."""

import itertools

from atlas_drake.messages import Message


def filled(kind):
    """A message of a kind whose numbers all differ."""
    numbers = itertools.count(2)

    def fill(message):
        for name in message.__dataclass_fields__:
            value = getattr(message, name)
            if isinstance(value, Message):
                fill(value)
            elif isinstance(value, list) and value:
                [fill(part) for part in value]
            elif isinstance(value, list):
                setattr(message, name, [next(numbers) % 256 for _ in range(28)])
            elif isinstance(value, bool):
                setattr(message, name, True)
            elif isinstance(value, (int, float)):
                setattr(message, name, type(value + 0)(next(numbers)))
        return message

    return fill(kind())
