"""What an import found, guessed and repaired, and why it refuses a file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from atlas_drake.errors import AtlasError, printable

FOUND, GUESSED, REPAIRED, LOST = "found", "guessed", "repaired", "left out"
_SHOWN = 6


class ImportRefused(AtlasError):
    """A file that cannot become a robot; names the link or the joint and its number."""


@dataclass
class Findings:
    """The findings so far, each said at once.

    Attributes:
        say: Takes each finding as a line of text.
        lines: Kind and text of each finding.
    """

    say: Callable[[str], object]
    lines: list[tuple[str, str]] = field(default_factory=list)

    def add(self, kind: str, text: str) -> None:
        """Adds a finding of one of the kinds above."""
        text = printable(text)
        self.lines.append((kind, text))
        self.say(f"{kind:>9}  {text}")

    def add_about(self, names: Sequence[str], kind: str, text: str) -> None:
        """Adds a finding about links or joints, if there are any."""
        if names:
            self.add(kind, f"{text}: {listed(names)}")

    def of(self, kind: str) -> list[str]:
        """Returns the texts of one kind."""
        return [text for known, text in self.lines if known == kind]


def listed(names: Sequence[str]) -> str:
    """Returns the first names, and how many more there are."""
    more = len(names) - _SHOWN
    text = ", ".join(names[:_SHOWN])
    return f"{text} and {more} more" if more > 0 else text
