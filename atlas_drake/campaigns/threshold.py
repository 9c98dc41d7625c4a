"""Search for the largest value under which the robot still succeeds.

The records alone determine the next trials, so that a stopped search can continue.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from atlas_drake.campaigns.campaign import Campaign
from atlas_drake.campaigns.plan import Trial, case_list, make_trial

Record = Mapping[str, Any]
"""The result of a trial."""
Records = Mapping[int, Record]
"""Records by the number of their trial."""


@dataclass(frozen=True)
class Found:
    """The state of a search of one case.

    Attributes:
        case: Values of the case by path.
        borne: Largest value under which enough trials succeeded.
        too_much: Smallest value under which they did not; None if there is none so far.
        ended: True if the search is over.
    """

    case: dict[str, Any]
    borne: float
    too_much: float | None
    ended: bool


class Search:
    """The search of one case."""

    def __init__(self, campaign: Campaign, case: int) -> None:
        """Searches in the case with this number."""
        assert campaign.threshold is not None
        self._campaign, self._case = campaign, case
        self._threshold = campaign.threshold
        self._cases = case_list(campaign)

    def next_trials(self, records: Records) -> list[Trial]:
        """Returns the trials to run next; empty when the search is over.

        The first round has as many replicas as must succeed; a second round has the
        others, if the first does not decide.
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
        """Returns the state of the search after these records."""
        borne, too_much, level = self._state(records)
        upper = None if too_much is None else self._threshold.value(too_much)
        lower = self._threshold.value(borne)
        return Found(self._cases[self._case], lower, upper, level is None)

    def _state(self, records: Records) -> tuple[int, int | None, int | None]:
        """Returns the level borne, the level not borne, and the level to try next."""
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
        """Returns whether a level is borne; None if missing trials still decide."""
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
    """Returns the level that a trial tries; None without threshold."""
    if campaign.threshold is None:
        return None
    return number // len(case_list(campaign)) // campaign.threshold.replicas
