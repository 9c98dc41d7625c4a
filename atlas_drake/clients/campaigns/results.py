"""The folder of a campaign: what was asked, and one JSON line for each finished trial.

The main process alone writes, so that a campaign that was killed continues where it
stopped. Tables, report and figures are in ``report``.
"""

from __future__ import annotations

import fcntl
import json
import os
from pathlib import Path
from typing import Any, Self

from pydrake.common.yaml import yaml_dump

from atlas_drake.atomic_write import atomic_write, why_not_readable
from atlas_drake.clients.campaigns.campaign import Campaign
from atlas_drake.clients.campaigns.plan import Record, Records
from atlas_drake.config import as_plain, checked, read_file, read_yaml
from atlas_drake.errors import ScenarioError, shown
from atlas_drake.scenario.differences import flat

CAMPAIGN, TRIALS = "campaign.yaml", "trials.jsonl"
"""Names in the folder."""
FREE = ("name", "trials", "trial_timeout", "goal")
"""Fields that may change when a campaign continues, because they change no result."""


def read_campaign(folder: Path) -> Campaign:
    """Reads the campaign of a folder."""
    file = folder / CAMPAIGN
    try:
        fields = read_yaml(read_file(file))
    except Exception as error:  # The parser raises many kinds of exception.
        problem = f"{folder} holds no campaign: {error}"
        raise ScenarioError("folder", str(folder), problem) from error
    try:
        campaign: Campaign = checked(Campaign, fields)
    except ScenarioError as error:
        raise error.within(file) from None
    return campaign


def read_records(folder: Path) -> Records:
    """Reads the records of a folder, also while a campaign writes them."""
    file = folder / TRIALS
    text = file.read_bytes() if why_not_readable(file) is None else b""
    records = {}
    # What follows the last line end is of a record that is being written.
    for number, line in enumerate(text.split(b"\n")[:-1], start=1):
        try:
            record: Record = json.loads(line)
            records[int(record["trial"])] = record
        except (ValueError, KeyError, TypeError) as error:
            problem = f"line {number} of {file} is no record of a trial: {error!r}"
            raise ScenarioError("folder", str(folder), problem) from error
    return records


class Results:
    """The folder of a campaign that runs, closed to other programs.

    Attributes:
        records: Records by the number of their trial.
    """

    def __init__(self, folder: Path, campaign: Campaign) -> None:
        """Makes the folder, or refuses one of another campaign or another program."""
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # Unbuffered: after an error nothing waits to be written.
            self._file: Any = (folder / TRIALS).open("ab", buffering=0)
        except OSError as error:
            problem = f"{folder} cannot be written: {error.strerror}"
            raise ScenarioError("--out", str(folder), problem) from None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            _keep(campaign, folder)
            self.records = read_records(folder)
            self._cut_torn_line(folder / TRIALS)
        except BlockingIOError:
            self._file.close()
            problem = f"another program is running a campaign in {folder}"
            raise ScenarioError("--out", str(folder), problem) from None
        except BaseException:
            self._file.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def add(self, line: bytes) -> Record:
        """Writes the line of a trial's record, and returns the record."""
        rest = line + b"\n"
        while rest:
            rest = rest[self._file.write(rest) :]
        os.fsync(self._file.fileno())
        record: Record = json.loads(line)
        self.records[record["trial"]] = record
        return record

    def _cut_torn_line(self, file: Path) -> None:
        """Removes what a program that was killed left after the last line."""
        self._file.truncate(file.read_bytes().rfind(b"\n") + 1)


def _keep(campaign: Campaign, folder: Path) -> None:
    """Writes what is asked, after a check that earlier results belong to it."""
    now = as_plain(campaign)
    if (folder / CAMPAIGN).exists():
        before = as_plain(read_campaign(folder))
        ours, theirs = _compared(now), _compared(before)
        for path in {**theirs, **ours}:
            if ours.get(path) != theirs.get(path):
                old, new = shown(theirs.get(path)), shown(ours.get(path))
                problem = (
                    f"{folder} holds results of another campaign: {path} is {new}, and "
                    f"was {old}; choose another folder"
                )
                raise ScenarioError("--out", str(folder), problem)
    with atomic_write(folder / CAMPAIGN) as unfinished:
        unfinished.write_text(yaml_dump(now), encoding="utf-8")


def _compared(campaign: dict[str, Any]) -> dict[str, Any]:
    """Returns the values by path that decide about results; of files their names."""
    fields = {name: campaign[name] for name in campaign if name not in FREE}
    return flat(fields | {"code": [Path(file).name for file in campaign["code"]]})


def as_line(record: Record) -> bytes:
    """Returns a record as JSON, with ``?`` for what no file can hold."""
    text = json.dumps(record, ensure_ascii=False, default=str)
    return text.encode(errors="replace")


def same_result(record: Record) -> Record:
    """Returns the part of a record that is the same on every machine."""
    figures = {k: v for k, v in record["figures"].items() if not k.startswith("tick_")}
    return {k: v for k, v in record.items() if k != "machine"} | {"figures": figures}
