"""Facts about a log as a whole, and what can be wrong with one."""

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

FORMAT, VERSION = "atlas_drake log", 2
SHOWN = ("name", "number", "color", "description")
"""Fields of a user's own behavior that a log holds."""
PLOT_EXTRA = "plot"
"""Extra of the package that installs the packages of figures."""


class LogError(AtlasError):
    """A log that cannot be written, read, drawn or replayed."""


class MissingPackageError(LogError):
    """An optional package that is not installed, and how to install it."""


def missing_package(what: str, name: str | None, extra: str) -> MissingPackageError:
    """Makes the error for a package, or a module in it, that an extra would install."""
    package = (name or "").partition(".")[0]
    return MissingPackageError(
        f"{what} needs the package {package!r}, which is not installed: "
        f"pip install {package}, or atlas-drake with the extra [{extra}]"
    )


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
        """Converts to text, with the schema and what identifies a log."""
        return json.dumps(
            {
                "format": FORMAT,
                "version": VERSION,
                "model": self.model,
                "control_period": self.control_period,
                "scenario": self.scenario,
                "behaviors": [
                    {name: getattr(entry, name) for name in SHOWN}
                    for entry in self.behaviors
                ],
                "schema": schema.to_plain(),
                "columns": {
                    name: {"unit": column.unit, "about": column.about}
                    for name, column in schema.columns.items()
                },
            }
        )


def read_header(text: str) -> tuple[Header, Schema]:
    """Reads header and schema; the reverse of ``Header.to_json``.

    Raises:
        LogError: If the text is not a header of a log, or has another version.
    """
    try:
        plain = json.loads(text)
        if plain["format"] != FORMAT:
            raise LogError(f"its format is {plain['format']!r}, not {FORMAT!r}")
        if plain["version"] != VERSION:
            raise LogError(
                f"its format has version {plain['version']}, and this program reads "
                f"version {VERSION}: record it again, or read it with the program that "
                "wrote it"
            )
        header = Header(
            str(plain["model"]),
            float(plain["control_period"]),
            str(plain["scenario"]),
            tuple(
                BehaviorInterface(**{name: entry[name] for name in SHOWN})
                for entry in plain["behaviors"]
            ),
        )
        return header, Schema.from_plain(plain["schema"])
    except (KeyError, TypeError, ValueError) as error:
        raise LogError("its header is invalid") from error
