"""Facts about a log as a whole, and the error of logs."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property

from atlas_drake.errors import AtlasError
from atlas_drake.messages.behavior_catalog import (
    SHIPPED,
    BehaviorCatalog,
    BehaviorInterface,
)
from atlas_drake.records import Schema

VERSION = 2
"""Version of the format: of topics, their messages, and the header."""
KEPT = ("name", "number", "color", "description")
"""Fields of a user's own behavior that a log holds."""


class LogError(AtlasError):
    """A log that cannot be written, read, drawn or replayed."""


@dataclass(frozen=True)
class Header:
    """Facts about a log as a whole.

    Attributes:
        model: Name of the robot, or the path of its file.
        control_period: Time between records [s].
        scenario: The scenario as YAML.
        behaviors: The user's own behaviors, beside the shipped ones.
    """

    model: str
    control_period: float
    scenario: str
    behaviors: tuple[BehaviorInterface, ...] = ()

    @cached_property
    def catalog(self) -> BehaviorCatalog:
        """All behaviors of the run."""
        return BehaviorCatalog((*SHIPPED, *self.behaviors))

    def to_json(self, schema: Schema) -> str:
        """Converts to text, with the schema of the records."""
        return json.dumps(
            {
                "version": VERSION,
                "model": self.model,
                "control_period": self.control_period,
                "scenario": self.scenario,
                "behaviors": [
                    {name: getattr(entry, name) for name in KEPT}
                    for entry in self.behaviors
                ],
                "schema": schema.to_plain(),
            }
        )


def read_header(text: str) -> tuple[Header, Schema]:
    """Reads header and schema; the reverse of ``Header.to_json``."""
    plain = json.loads(text)
    if plain["version"] != VERSION:
        raise LogError(
            f"its format has version {plain['version']}, and this program reads "
            f"version {VERSION}: record it again, or read it with the program that "
            "wrote it"
        )
    header = Header(
        plain["model"],
        plain["control_period"],
        plain["scenario"],
        tuple(BehaviorInterface(**entry) for entry in plain["behaviors"]),
    )
    return header, Schema.from_plain(plain["schema"])
