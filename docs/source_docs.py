"""Reads the docstrings of fields and constants from the source, for the reference.

Fields and constants have strings after an assignment, see ``atlas_drake.config``.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
import textwrap
from types import ModuleType
from typing import Any

from atlas_drake import config
from atlas_drake.messages import Message
from atlas_drake.units import unit_of


def paragraphs(text: str | None) -> str:
    """Converts a docstring to Markdown, with its code marks and indented blocks."""
    text = inspect.cleandoc(text or "")
    return re.sub(r"``([^`]+)``", r"`\1`", text)


def head(text: str | None) -> str:
    """A docstring without its Google-style sections."""
    text = inspect.cleandoc(text or "")
    text = re.split(r"\n\s*(?:Attributes|Args|Returns|Raises|Example):\n", text)[0]
    return paragraphs(text)


def attributes(cls: type) -> dict[str, str]:
    """Reads the description of each field in the ``Attributes`` section."""
    text = inspect.cleandoc(cls.__doc__ or "")
    match = re.search(r"(?:^|\n)Attributes:\n((?:    .*\n?|\n)+)", text)
    if not match:
        return {}
    found: dict[str, str] = {}
    current = ""
    for line in textwrap.dedent(match.group(1)).splitlines():
        entry = re.match(r"([\w, ]+): (.*)", line)
        if entry and not line.startswith(" "):
            current = entry.group(1)
            found[current] = entry.group(2)
        elif line.strip():
            found[current] += " " + line.strip()
    return {
        name.strip(): paragraphs(text)
        for names, text in found.items()
        for name in names.split(",")
    }


def trailing_strings(owner: type | ModuleType) -> dict[str, str]:
    """The strings that follow assignments in a class or a module, as Markdown."""
    told = config.trailing_strings(owner)
    return {name: paragraphs(text).replace("\n", " ") for name, text in told.items()}


def fields(cls: type) -> dict[str, str]:
    """The text of each field of a dataclass as Markdown, with its unit."""
    told = attributes(cls)
    for one in reversed(cls.__mro__[:-1]):
        told |= trailing_strings(one)
    for name, kind in config.fields_of(cls).items():
        if name in told and (unit := unit_of(kind)):
            # After the first sentence, which says what the number is.
            told[name] = re.sub(r"(?=[.:;](\s|$))", f" [{unit}]", told[name], count=1)
    return told


def defaults(cls: type) -> dict[str, Any]:
    """The value with which each field of a dataclass begins."""
    needed = {field.name: dataclasses.MISSING for field in dataclasses.fields(cls)}
    return needed | config.defaults(cls)


def is_parameter_set(value: object) -> bool:
    """Returns True for a dataclass with defaults for all numbers that is no message."""
    return (
        inspect.isclass(value)
        and dataclasses.is_dataclass(value)
        and not issubclass(value, Message)
        and len(dataclasses.fields(value)) > 0
        and all(isinstance(v, int | float) for v in defaults(value).values())
    )
