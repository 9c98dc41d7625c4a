"""The folder of a campaign: its description, and one file for each finished trial.

Files are written whole or not at all, so that a campaign that was killed continues
where it stopped. The table of all results is in ``table``.
"""

from __future__ import annotations

import fcntl
import functools
import hashlib
import json
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

from pydrake.common.yaml import yaml_dump, yaml_load

import atlas_drake
from atlas_drake.atomic_write import atomic_write
from atlas_drake.campaigns.campaign import Campaign
from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.campaigns.sources import Sources
from atlas_drake.config import as_plain, checked
from atlas_drake.errors import shown
from atlas_drake.scenario.differences import flat

CAMPAIGN, TRIALS = "campaign.yaml", "trials"
"""Names in the folder."""
FREE = ("name", "trials", "trial_timeout", "goal", "code")
"""Fields of a campaign that may change when it continues, because they change no
result. For ``code`` the contents of the files are compared, and not their paths."""
HASHED = (".py", ".yaml", ".urdf")
"""Endings of the package's files that results depend on."""
FIELDS: dict[str, Any] = {
    "trial": int,
    "seed": int,
    "values": dict,
    "success": bool,
    "missed": list,
    "figures": dict,
    "error": str | None,
}
"""Types of the fields of every record."""
_NAME = re.compile(r"(\d+)\.json")


class CampaignFolder:
    """A folder with a campaign and its results.

    Attributes:
        path: Path of the folder.
    """

    def __init__(self, path: Path) -> None:
        """Refers to a folder, which need not exist."""
        self.path = path

    def begin(self, campaign: Campaign, sources: Sources) -> None:
        """Makes the folder, or checks that it belongs to the same campaign.

        Raises:
            CampaignError: If it belongs to another campaign, or cannot be written.
        """
        text = _description(campaign, sources)
        try:
            (self.path / TRIALS).mkdir(parents=True, exist_ok=True)
            file = self.path / CAMPAIGN
            if not file.exists():
                with atomic_write(file) as unfinished:
                    unfinished.write_text(text, encoding="utf-8")
                return
        except OSError as error:
            problem = f"{self.path} cannot be written: {error.strerror}"
            raise CampaignError("--out", str(self.path), problem) from error
        before, now = self._read(), yaml_load(data=text)
        difference = _difference(before, now)
        if difference is not None:
            field, old, new = difference
            raise CampaignError(
                "--out",
                str(self.path),
                f"{self.path} holds results of another campaign: {field} is "
                f"{shown(new)}, and was {shown(old)}; choose another folder",
            )

    def campaign(self) -> Campaign:
        """Reads the campaign of this folder.

        Raises:
            CampaignError: If the folder holds no campaign.
        """
        fields = dict(self._read()["campaign"])
        campaign: Campaign = checked(Campaign, fields)
        return campaign

    def _read(self) -> Any:
        file = self.path / CAMPAIGN
        if not file.is_file():
            problem = f"{self.path} holds no campaign: there is no {CAMPAIGN} in it"
            raise CampaignError("folder", str(self.path), problem)
        try:
            found = yaml_load(data=file.read_text(encoding="utf-8"))
            found["campaign"].items()
        except Exception as error:  # The parser raises many kinds of exception.
            problem = f"{file} cannot be read: {error}"
            raise CampaignError("folder", str(self.path), problem) from error
        return found

    def file_of(self, number: int) -> Path:
        """Returns the path of a trial's record."""
        return self.path / TRIALS / f"{number:06d}.json"

    def write(self, record: Mapping[str, Any]) -> None:
        """Writes the record of a trial; ``only_one`` keeps a second program away."""
        file = self.file_of(record["trial"])
        with atomic_write(file, unfinished_as=file.stem) as unfinished:
            unfinished.write_bytes(_as_json(record))

    def records(self) -> dict[int, dict[str, Any]]:
        """Reads every record, by the number of its trial.

        Raises:
            CampaignError: If a file is not a trial's record.
        """
        found = {}
        folder = self.path / TRIALS
        for file in sorted(folder.iterdir()) if folder.is_dir() else []:
            name = _NAME.fullmatch(file.name)
            if name is None:
                continue
            number = int(name[1])
            try:
                record = json.loads(file.read_text(encoding="utf-8"))
                _check_record(record, number)
            except (OSError, ValueError) as error:
                problem = (
                    f"{file} is not the record of trial {number}: {error}; delete it, "
                    "and `atlas-drake sweep` runs the trial again"
                )
                raise CampaignError("folder", str(self.path), problem) from error
            found[number] = record
        return found

    @contextmanager
    def only_one(self, shard: str) -> Iterator[None]:
        """Locks a shard against a second program.

        Raises:
            CampaignError: If another program has locked it.
        """
        with (self.path / f".running-{shard}").open("w") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                problem = f"another program is running this campaign in {self.path}"
                raise CampaignError("--out", str(self.path), problem) from None
            yield

    @contextmanager
    def writing_results(self) -> Iterator[None]:
        """Waits until no other program writes results.

        Files of results can then have one unfinished name each: what a killed program
        left unfinished is completed by the next one, and does not stay behind.

        Raises:
            OSError: If the folder cannot be written.
        """
        with (self.path / ".writing").open("w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            yield


def merge(target: CampaignFolder, sources: list[CampaignFolder]) -> int:
    """Copies the results of shards into one folder.

    Returns:
        Number of copied records.

    Raises:
        CampaignError: If the campaigns differ, or two records of a trial do.
    """
    target.path.mkdir(parents=True, exist_ok=True)
    (target.path / TRIALS).mkdir(exist_ok=True)
    present, copied = target.records(), 0
    for source in sources:
        theirs = source._read()
        file = target.path / CAMPAIGN
        if not file.exists():
            with atomic_write(file) as unfinished:
                unfinished.write_bytes((source.path / CAMPAIGN).read_bytes())
        difference = _difference(target._read(), theirs)
        if difference is not None:
            field, one, other = difference
            problem = (
                f"{source.path} is of another campaign: {field} is {shown(other)}, "
                f"and {shown(one)} in {target.path}"
            )
            raise CampaignError("folder", str(source.path), problem)
        for number, record in source.records().items():
            if number not in present:
                target.write(record)
                present[number] = record
                copied += 1
            elif same_result(record) != same_result(present[number]):
                problem = f"trial {number} of {source.path} contradicts {target.path}"
                raise CampaignError("folder", str(source.path), problem)
    return copied


def as_kept(record: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the record as ``records`` reads it after ``write``."""
    kept: dict[str, Any] = json.loads(_as_json(record))
    return kept


def _check_record(record: object, number: int) -> None:
    """Checks the fields of a record that was read.

    Raises:
        ValueError: If it is not the record of this trial.
    """
    if not isinstance(record, dict):
        raise ValueError(f"it is {shown(record)}")
    for name, kind in FIELDS.items():
        if name not in record:
            raise ValueError(f"it has no {name}")
        if not isinstance(record[name], kind):
            raise ValueError(f"its {name} is {shown(record[name])}")
    if record["trial"] != number:
        raise ValueError(f"its trial is {record['trial']}")


def _as_json(record: Mapping[str, Any]) -> bytes:
    """Converts to JSON, with ``?`` for a lone surrogate, which no file can hold."""
    text = json.dumps(record, indent=1, ensure_ascii=False, default=str)
    return f"{text}\n".encode(errors="replace")


def same_result(record: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the part of a record that is the same on every machine."""
    figures = {k: v for k, v in record["figures"].items() if not k.startswith("tick_")}
    kept = {k: v for k, v in record.items() if k != "machine"}
    return {**kept, "figures": figures}


def _description(campaign: Campaign, sources: Sources) -> str:
    description = {
        "campaign": as_plain(campaign),
        "code": sources.fingerprints([campaign.trial, *campaign.metrics]),
        "versions": {"drake": version("drake"), "atlas_drake": _fingerprint()},
    }
    return yaml_dump(description)


@functools.cache
def _fingerprint() -> str:
    """Hash of code and models; results are comparable only for equal hashes."""
    digest = hashlib.sha256()
    files = []
    for folder, _, names in os.walk(
        Path(atlas_drake.__file__).parent, followlinks=True
    ):
        files += [Path(folder, name) for name in names if name.endswith(HASHED)]
    for file in sorted(files):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


def _difference(before: Any, now: Any) -> tuple[str, Any, Any] | None:
    """Returns path and both values of the first difference that matters, or None."""
    one, other = (
        flat({**found, "campaign": {k: v for k, v in fields.items() if k not in FREE}})
        for found, fields in ((before, before["campaign"]), (now, now["campaign"]))
    )
    for path in {**one, **other}:
        if one.get(path) != other.get(path):
            return path.removeprefix("campaign."), one.get(path), other.get(path)
    return None
