"""Facts about a log as a whole, and the error of logs."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from atlas_drake.config import Configuration, Positive, checked, read_fields
from atlas_drake.errors import AtlasError
from atlas_drake.messages.behavior_catalog import (
    SHIPPED,
    BehaviorCatalog,
    BehaviorInterface,
)
from atlas_drake.records import Schema

VERSION = 2
"""Version of the format: of topics, their messages, and the header."""


class LogError(AtlasError):
    """A log that cannot be written, read, drawn or replayed."""


@dataclass(frozen=True, kw_only=True)
class OwnBehavior(Configuration):
    """What a log holds of a user's own behavior."""

    name: str
    number: int
    color: str
    description: str


@dataclass(frozen=True)
class Header:
    """Facts about a log as a whole.

    Each is checked when it is asked for, so that a damaged one stops only who needs it:
    it raises a ``LogError``.

    Attributes:
        given: The facts by name, as they stand in the file.
        path: The file.
    """

    given: Mapping[str, Any]
    path: Path = Path("log")

    @cached_property
    def model(self) -> str:
        """Name of the robot, or the path of its file."""
        return str(self._fact("model", str))

    @cached_property
    def control_period(self) -> float:
        """Time between records [s]."""
        return float(self._fact("control_period", Positive))

    @cached_property
    def scenario(self) -> dict[str, Any]:
        """The fields of the scenario; another version may not know all of them."""
        text = self._fact("scenario", str)
        try:
            return read_fields(text, "name: run")
        except AtlasError as error:
            raise self._damaged("scenario", error) from None

    @cached_property
    def catalog(self) -> BehaviorCatalog:
        """All behaviors of the run: the shipped ones and the user's own."""
        own = self._fact("behaviors", list[OwnBehavior])
        entries = [BehaviorInterface(**vars(behavior)) for behavior in own]
        try:
            return BehaviorCatalog((*SHIPPED, *entries))
        except AtlasError as error:
            raise self._damaged("behaviors", error) from None

    def faults(self) -> list[str]:
        """Returns what is damaged, each in a sentence."""
        found = []
        for name in ("model", "control_period", "scenario", "catalog"):
            try:
                getattr(self, name)
            except LogError as error:
                found.append(str(error))
        return found

    def _fact(self, name: str, kind: Any) -> Any:
        try:
            return checked(kind, self.given.get(name), name)
        except AtlasError as error:
            raise self._damaged("", error) from None

    def _damaged(self, name: str, error: AtlasError) -> LogError:
        where = f"{name}: " if name else ""
        return LogError(f"{self.path}: its header is damaged: {where}{error}")

    def to_json(self, schema: Schema) -> str:
        """Converts to text, with the schema of the records."""
        return json.dumps(
            {"version": VERSION, **self.given, "schema": schema.to_plain()}
        )


def read_header(text: str, path: Path) -> tuple[Header, Schema]:
    """Reads header and schema; the reverse of ``Header.to_json``."""
    try:
        plain = json.loads(text)
    except ValueError as error:
        raise LogError(f"its header is no JSON: {error}") from None
    version = plain.get("version") if isinstance(plain, dict) else None
    if version != VERSION:
        raise LogError(
            f"its format has version {version}, and this program reads version "
            f"{VERSION}: record it again, or read it with the program that wrote it"
        )
    try:
        return Header(plain, path), Schema.from_plain(plain.get("schema"))
    except ValueError as error:
        raise LogError(f"its header is damaged: {error}") from None
