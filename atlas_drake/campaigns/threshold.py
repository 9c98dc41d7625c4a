"""The largest value that is borne: which values are tried next, and what was found.

The same records always lead to the same next step, so that a search goes on where it
was stopped.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from atlas_drake.campaigns.campaign import Campaign
from atlas_drake.campaigns.plan import Trial, case_list, make_trial

Records = Mapping[int, Mapping[str, Any]]
"""Results by the number of their trial."""


@dataclass(frozen=True)
class Found:
    """The state of a search of one case.

    Attributes:
        case: Values of the case by path.
        borne: Largest value known to be borne.
        too_much: Smallest value known not to be; None if none was met.
        ended: True if the search is over.
    """

    case: dict[str, Any]
    borne: float
    too_much: float | None
    ended: bool


class Search:
    """The search of one case."""

    def __init__(self, campaign: Campaign, case: int) -> None:
        """Searches in the case of this number."""
        assert campaign.threshold is not None
        self._campaign, self._case = campaign, case
        self._threshold = campaign.threshold
        self._cases = case_list(campaign)

    def next_trials(self, records: Records) -> list[Trial]:
        """Trials that are needed next and not done; empty when the search is over.

        First as many replicas as have to pass; the others only if these do not decide.
        """
        level = self._state(records)[2]
        if level is None:
            return []
        numbers = self._numbers(level)
        for needed in (numbers[: self._threshold.passes], numbers):
            missing = [number for number in needed if number not in records]
            if missing:
                break
        return [make_trial(self._campaign, number, level) for number in missing]

    def found(self, records: Records) -> Found:
        """What the records say."""
        borne, too_much, level = self._state(records)
        upper = None if too_much is None else self._threshold.value(too_much)
        lower = self._threshold.value(borne)
        return Found(self._cases[self._case], lower, upper, level is None)

    def _state(self, records: Records) -> tuple[int, int | None, int | None]:
        """Level borne, level that is too much, and the level to try next."""
        top = self._threshold.levels
        borne, too_much = 0, None
        while True:
            highest = top + 1 if too_much is None else too_much
            if highest - borne <= 1:
                return borne, too_much, None
            if self._threshold.search == "climb":
                level = borne + 1
            else:
                level = (borne + highest) // 2
            verdict = self._verdict(level, records)
            if verdict is None:
                return borne, too_much, level
            if verdict:
                borne = level
            else:
                too_much = level

    def _verdict(self, level: int, records: Records) -> bool | None:
        """True if a level is borne; None as long as missing trials decide."""
        threshold = self._threshold
        done = [records[n] for n in self._numbers(level) if n in records]
        passes = sum(bool(record["success"]) for record in done)
        if passes >= threshold.passes:
            return True
        if len(done) - passes > threshold.replicas - threshold.passes:
            return False
        return None

    def _numbers(self, level: int) -> list[int]:
        replicas, cases = self._threshold.replicas, len(self._cases)
        first = level * replicas
        return [(first + r) * cases + self._case for r in range(replicas)]


def level_of(campaign: Campaign, number: int) -> int | None:
    """The level that a trial of a threshold tries; None without threshold."""
    if campaign.threshold is None:
        return None
    return number // len(case_list(campaign)) // campaign.threshold.replicas
