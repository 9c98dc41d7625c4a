"""Makes requests to behaviors without a command interface; no test is here."""

import itertools

from atlas_drake.messages.commands import BehaviorRequest

_numbers = itertools.count(1)


def as_request(command):
    """What the command interface makes of a message; each has a number of its own."""
    return BehaviorRequest(command.behavior, command, next(_numbers))
