"""The base of this package's errors, shared errors, and the reported error codes.

The checks that raise them are beside the values that they check.
"""

import difflib
from collections.abc import Iterable
from enum import IntEnum
from typing import Self


class ErrorCode(IntEnum):
    """Values of ``AtlasSimInterfaceState.error_code``."""

    NO_ERRORS = 0
    """The last message was accepted."""
    UNSPECIFIED = -1
    """Any other fault. Never reported here: every fault has its own code."""
    VALUE_OUT_OF_RANGE = -2
    """An invalid number, or an array of the wrong length."""
    INVALID_INDEX = -3
    """A joint, foot or step that does not exist, or steps out of order."""
    FAILED_TO_START_BEHAVIOR = -4
    """The behavior cannot begin now; the status flags give the reason."""
    NO_ACTIVE_BEHAVIOR = -5
    """No behavior is active. Never reported here: one is always active."""
    NO_SUCH_BEHAVIOR = -6
    """A name or number of no behavior."""
    BEHAVIOR_NOT_IMPLEMENTED = -7
    """A behavior that the controller lacks. The shipped controller has all of them."""
    TIME_RAN_BACKWARD = -8
    """A time stamp earlier than that of the message before."""


class AtlasError(Exception):
    """Base of all errors of this package; catch it to catch all of them."""


class _FieldError(AtlasError, ValueError):
    """A fault in a field of a message or a file."""

    def __init__(self, field: str, value: object, problem: str) -> None:
        super().__init__(field, value, problem)
        self.field = field
        self.value = value
        self.problem = problem

    def __str__(self) -> str:
        """Names the field and the problem."""
        return f"{self.field}: {self.problem}"


class InvalidMessageError(_FieldError):
    """A message that cannot be applied; no part of it was applied.

    Attributes:
        field: Field at fault, as a path from the message, for example
            ``walk_params.step_queue[2].duration``.
        value: Value of the field.
        problem: What is wrong, and what would be right.
        error_code: Error code for ``AtlasSimInterfaceState.error_code``.
    """

    def __init__(
        self,
        field: str,
        value: object,
        problem: str,
        error_code: ErrorCode = ErrorCode.VALUE_OUT_OF_RANGE,
    ) -> None:
        super().__init__(field, value, problem)
        self.args = (field, value, problem, error_code)  # Pickling passes them back.
        self.error_code = error_code


class _FileError(_FieldError):
    """A fault in the contents of a file, or in the equivalent Python value."""

    @classmethod
    def about(cls, field: str, value: object, problem: str) -> Self:
        """Returns the error of a value that its message shows.

        Args:
            field: Where the value stands.
            value: The value.
            problem: What is wrong with it.
        """
        return cls(field, value, f"is {shown(value)}; {problem}")

    def within(self, file: object) -> Self:
        """Returns the same error, whose message names the file, too.

        Args:
            file: The file's path.
        """
        return type(self)(self.field, self.value, f"{self.problem} (in {file})")


class RobotDescriptionError(_FileError):
    """A robot that does not exist, or whose files cannot be used.

    Its attributes are those of a ``ScenarioError``.
    """


class ScenarioError(_FileError):
    """A scenario that cannot be run.

    Attributes:
        field: Field at fault, as a path from the top of the scenario.
        value: Value of the field.
        problem: What is wrong, and what would be right.
    """


class WaitTimeoutError(AtlasError, TimeoutError):
    """The awaited condition was not met within the given simulated time."""


SHOWN = 500
"""Longest text for a value in an error message [characters]."""


def shown(value: object) -> str:
    """Returns ``repr(value)``, shortened for an error message."""
    try:
        text = repr(value)
    except Exception:  # The user's own object may raise any error.
        return f"<{type(value).__name__} that cannot be shown>"
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 3]}..."


def printable(text: str) -> str:
    """Returns a text in one line of printable characters, the others escaped.

    Text of a file from elsewhere may hold control characters, which a terminal obeys,
    line breaks, and marks that turn the direction of reading.

    Args:
        text: The text.
    """
    return "".join(
        one if one.isprintable() else one.encode("unicode_escape").decode()
        for one in text
    )


def described(value: object) -> str:
    """Returns the text of a number or a word, and of other values their type."""
    plain = value is None or isinstance(value, int | float | complex | str)
    return shown(value) if plain else type(value).__name__


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Asks, after a space, for the valid word nearest to a mistyped one, if any is."""
    close = difflib.get_close_matches(word, list(known), n=1)
    return f" Did you mean {close[0]!r}?" if close else ""
