"""Every error that this package raises on purpose, and the error codes it reports.

The checks that raise them live beside what they check, not here.
"""

import difflib
from collections.abc import Iterable
from enum import IntEnum


class ErrorCode(IntEnum):
    """Values of ``AtlasSimInterfaceState.error_code``."""

    NO_ERRORS = 0
    """The last message was accepted."""
    UNSPECIFIED = -1
    """Something else went wrong. Never reported here: every fault has its code."""
    VALUE_OUT_OF_RANGE = -2
    """A number that cannot be used, or an array of the wrong length."""
    INVALID_INDEX = -3
    """A joint, foot or step that does not exist, or steps out of order."""
    FAILED_TO_START_BEHAVIOR = -4
    """The behavior cannot begin now; the status flags say why."""
    NO_ACTIVE_BEHAVIOR = -5
    """There is no behavior to do it. Never reported here: one is always active."""
    NO_SUCH_BEHAVIOR = -6
    """A name or number that no behavior has."""
    BEHAVIOR_NOT_IMPLEMENTED = -7
    """A behavior that this library lacks. Never reported here: it has all of them."""
    TIME_RAN_BACKWARD = -8
    """The message is stamped earlier than the one before."""


class AtlasError(Exception):
    """Base of all errors of this package: catch it to catch them all."""


class InvalidMessageError(AtlasError, ValueError):
    """A message that cannot be applied; nothing of it has been.

    Attributes:
        field: Where the fault is, as a path from the message, for example
            ``walk_params.step_queue[2].duration``.
        value: What the message has there.
        problem: What is wrong with it and what would be right.
        error_code: What the robot reports in ``AtlasSimInterfaceState.error_code``.
    """

    def __init__(
        self,
        field: str,
        value: object,
        problem: str,
        error_code: ErrorCode = ErrorCode.VALUE_OUT_OF_RANGE,
    ) -> None:
        # All arguments go to the base class because pickling passes them back.
        super().__init__(field, value, problem, error_code)
        self.field = field
        self.value = value
        self.problem = problem
        self.error_code = error_code

    def __str__(self) -> str:
        """Say what is wrong, where."""
        return f"{self.field}: {self.problem}"


class _FileError(AtlasError, ValueError):
    """What is wrong with the contents of a file, or with the same made in Python.

    Attributes:
        field: Where the fault is, as a path from the top of the file.
        value: What the file has there.
        problem: What is wrong with it and what would be right.
    """

    def __init__(self, field: str, value: object, problem: str) -> None:
        super().__init__(field, value, problem)
        self.field = field
        self.value = value
        self.problem = problem

    def __str__(self) -> str:
        """Say what is wrong, where."""
        return f"{self.field}: {self.problem}"


class RobotDescriptionError(_FileError):
    """A robot that does not exist, or whose files cannot be used.

    It has the attributes ``field``, ``value`` and ``problem``, as a ScenarioError.
    """


class ScenarioError(_FileError):
    """A scenario that cannot be run.

    Attributes:
        field: Where the fault is, as a path from the top of the scenario.
        value: What the scenario has there.
        problem: What is wrong with it and what would be right.
    """


class WaitTimeoutError(AtlasError, TimeoutError):
    """What was waited for did not come about within the simulated time allowed."""


SHOWN = 500
"""Longest text for a value in an error message [characters]."""


def shown(value: object) -> str:
    """Return ``repr(value)`` for an error message: short, whatever the value is.

    A value whose ``repr`` fails, as that of an integer of thousands of digits does, is
    described by its type.
    """
    try:
        text = repr(value)
    except Exception:  # An object of the user's may raise anything.
        return f"<{type(value).__name__} that cannot be shown>"
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 3]}..."


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Name the known word nearest to a mistyped one.

    Args:
        word: What was written.
        known: What could have been meant.

    Returns:
        A sentence with a leading space, to be appended to an error message; empty
        when nothing known resembles the word.
    """
    close = difflib.get_close_matches(word, list(known), n=1)
    return f" Did you mean {close[0]!r}?" if close else ""
