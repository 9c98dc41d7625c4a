"""Makes the reference pages of the site from the code, see ``site_hooks``."""

from __future__ import annotations

import dataclasses
import enum
import inspect
import sys
import types
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import source_docs

import atlas_drake
from atlas_drake import errors, messages
from atlas_drake.behaviors import base, fall, supervisor
from atlas_drake.behaviors.entry import EntryLimits, legal_transitions
from atlas_drake.behaviors.stand import stance_guard
from atlas_drake.config import LeastGreatest, as_plain
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.messages import Behavior, Message
from atlas_drake.robot import RobotFile, load_robot
from atlas_drake.robot import file as robot_file
from atlas_drake.robot import leg as robot_leg
from atlas_drake.scenario import Scenario
from atlas_drake.shipped import BEHAVIORS, CATALOG, CONTROLLER

_BEHAVIORS = {entry.name: entry.behavior for entry in BEHAVIORS}
_LEGAL = {
    _BEHAVIORS[source]: frozenset(map(_BEHAVIORS.__getitem__, targets))
    for source, targets in legal_transitions(BEHAVIORS).items()
}
NOTE = "*Written by `docs/make_reference.py` from the code; changes belong there.*"
PARAMS = {
    Behavior.WALK: "AtlasBehaviorWalkParams",
    Behavior.STEP: "AtlasBehaviorStepParams",
    Behavior.STAND: "AtlasBehaviorStandParams",
    Behavior.MANIPULATE: "AtlasBehaviorManipulateParams",
}
FLAGS = (messages.BehaviorStatus, messages.WalkStatus, messages.StepStatus)


def all_messages() -> dict[str, type]:
    """The messages that can be imported from ``atlas_drake``, by name."""
    return {
        name: value
        for name in messages.__all__
        if inspect.isclass(value := getattr(messages, name))
        and issubclass(value, Message)
        and value is not Message
    }


def table(header: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """A Markdown table."""
    lines = [header, tuple("---" for _ in header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def message_page(name: str, cls: type) -> str:
    """What a message is, field by field, with its constants."""
    told = source_docs.attributes(cls)
    values = source_docs.defaults(cls)
    known = all_messages()
    rows = []
    for field in dataclasses.fields(cls):
        kind = _kind(field.type)
        shown = f"[`{kind}`]({kind}.md)" if kind in known else f"`{kind}`"
        rows.append(
            (
                f"`{field.name}`",
                shown,
                _value(values[field.name]),
                told.get(field.name, ""),
            )
        )
    parts = [f"# {name}", source_docs.head(cls.__doc__)]
    parts.append(table(("field", "type", "at first", "meaning"), rows))
    constants = [
        (f"`{key}`", str(int(value)))
        for key, value in vars(cls).items()
        if isinstance(value, int) and key.isidentifier() and not key.startswith("_")
    ]
    if constants:
        parts += ["## Constants", table(("name", "value"), constants)]
    return "\n\n".join([*parts, NOTE]) + "\n"


def behavior_page(behavior: Behavior, implementation: base.BehaviorProtocol) -> str:
    """What a behavior does, when it can begin, what it reads, says and keeps to."""
    guard = None
    if isinstance(implementation, stance_guard.StanceGuard):
        guard = stance_guard.__doc__
        implementation = implementation.behavior
    module = sys.modules[type(implementation).__module__]
    legal = _LEGAL
    before = [b.name for b in legal if behavior in legal[b]]
    after = [b.name for b in legal if b in legal[behavior]]
    told = source_docs.trailing_strings(Behavior)
    parts = [
        f"# {behavior.name} ({behavior.value})",
        told.get(behavior.name) or CATALOG.entry(behavior).description,
        source_docs.paragraphs(module.__doc__),
        f"**Can follow:** {', '.join(before)}.",
        f"**Can be followed by:** {', '.join(after)}.",
    ]
    if behavior in PARAMS:
        params = PARAMS[behavior]
        feedback = params.replace("Params", "Feedback")
        parts.append(
            f"**Reads** [`{params}`](../{params}.md), **reports** "
            f"[`{feedback}`](../{feedback}.md)."
        )
    if guard:
        parts += ["## Without a leg", source_docs.paragraphs(guard)]
    tuned = _tuned(CONTROLLER)
    sets = [
        v
        for v in vars(module).values()
        if source_docs.is_parameter_set(v) and v not in tuned
    ]
    parts += ["## Numbers", "[All that can be tuned](../scenario.md#controller)."]
    for cls in sets:
        parts += [f"### {cls.__name__}", source_docs.head(cls.__doc__), _numbers(cls)]
    return "\n\n".join([*parts, NOTE]) + "\n"


def _tuned(value: Any) -> set[type]:
    """Dataclasses in a configuration, its own included."""
    if not dataclasses.is_dataclass(value):
        return set()
    return {type(value)}.union(*(_tuned(item) for item in vars(value).values()))


def transitions_page() -> str:
    """The table of legal transitions, and the conditions of entering."""
    rows = [
        (
            f"**{source.name}**",
            *("yes" if target in _LEGAL[source] else "" for target in _LEGAL),
        )
        for source in _LEGAL
    ]
    header = ("from \\ to", *(b.name for b in _LEGAL))
    parts = [
        "# Transitions",
        "Which behavior may follow which, by request.",
        table(header, rows),
        _drawing(),
        "Any other change is refused with FAILED_TRANS_ILLEGAL_BEHAVIOR and"
        " FAILED_TO_START_BEHAVIOR; what was active goes on.",
        "## When a behavior that balances can begin",
        source_docs.head(EntryLimits.__doc__),
        _numbers(EntryLimits),
        "## When the robot counts as falling",
        source_docs.head(fall.FallLimits.__doc__),
        _numbers(fall.FallLimits),
    ]
    return "\n\n".join([*parts, NOTE]) + "\n"


def _drawing() -> str:
    """The same as a picture, without those that may follow at any moment."""
    legal = _LEGAL
    always = frozenset.intersection(*legal.values())
    arrows = [
        f"    {source.name} --> {target.name}"
        for source in legal
        for target in sorted(legal[source] - always)
        if source is not target
    ]
    names = ", ".join(b.name for b in Behavior if b in always)
    picture = "\n".join(["```mermaid", "stateDiagram-v2", *arrows, "```"])
    return f"{names} may be asked for at any moment; all others:\n\n{picture}"


def flags_page() -> str:
    """Status flags of all kinds, and error codes."""
    parts = ["# Flags and error codes"]
    for kind in (*FLAGS, errors.ErrorCode):
        told = source_docs.trailing_strings(kind)
        rows = [
            (f"`{member.name}`", str(member.value), told.get(str(member.name), ""))
            for member in kind.__members__.values()
        ]
        parts += [
            f"## {kind.__name__}",
            source_docs.head(kind.__doc__),
            table(("name", "value", "meaning"), rows),
        ]
    return "\n\n".join([*parts, NOTE]) + "\n"


def robot_page() -> str:
    """Every field of a robot's file, with unit and default."""
    parts = [
        "# A robot's file",
        source_docs.paragraphs(robot_file.__doc__),
        "How to write one: [models/README.md](../../models/README.md).",
        _numbers(RobotFile),
    ]
    for name, value in source_docs.defaults(RobotFile).items():
        kind = RobotFile.__annotations__[name]
        kinds = typing.get_args(kind) if typing.get_origin(kind) is list else ()
        cls = kinds[0] if kinds else kind
        if not dataclasses.is_dataclass(cls):
            continue
        parts += [
            f"## {name}{'[i]' if kinds else ''}",
            source_docs.head(cls.__doc__),
            _numbers(cls, vars(value) if isinstance(value, cls) else None),
        ]
    parts += ["## Layout of a leg", source_docs.paragraphs(robot_leg.__doc__)]
    return "\n\n".join([*parts, NOTE]) + "\n"


def scenario_page() -> str:
    """Every field of a scenario that can be given in YAML or by ``--set``."""
    parts = [
        "# Fields of a scenario",
        "In a YAML file nested; on the command line `--set key.path=value`. Checks of "
        "the values are in [`scenario.py`](../../atlas_drake/scenario/scenario.py). A "
        "robot's file gives values of its own for `controller`, at the same paths.",
        *_fields_of(dataclasses.replace(Scenario(), controller=CONTROLLER), ""),
    ]
    return "\n\n".join([*parts, NOTE]) + "\n"


def _fields_of(value: Any, path: str) -> list[str]:
    """A table of the plain fields, and then one of each structure among them."""
    if not dataclasses.is_dataclass(value):
        # Which fields there are depends on the version of Drake.
        drakes = as_plain(type(value)())
        rows = [
            (f"`{name}`", _value(item))
            for name, item in as_plain(value).items()
            if item != drakes[name]
        ]
        told = f"Drake's `{type(value).__name__}`, with all its fields."
        if not rows:
            return [f"## {path}", told]
        told += " Other than in Drake:"
        return [f"## {path}", told, table(("name", "value"), rows)]
    told = source_docs.fields(type(value))
    rows, parts = [], []
    for field in dataclasses.fields(value):
        item, where = getattr(value, field.name), f"{path}.{field.name}".lstrip(".")
        absent = _absent_structure(type(value), field.name) if item is None else None
        if absent is not None:
            rows.append((f"`{field.name}`", _value(item), told.get(field.name, "")))
            parts += _fields_of(absent, where)
        elif dataclasses.is_dataclass(item) or hasattr(item, "__fields__"):
            parts += _fields_of(item, where)
        else:
            rows.append((f"`{field.name}`", _value(item), told.get(field.name, "")))
            if not path and (element := _absent_structure(type(value), field.name)):
                parts += _fields_of(element, f"{where}[i]")
    head = [f"## {path}", source_docs.head(type(value).__doc__)] if path else []
    if rows:
        head.append(table(("name", "value", "meaning"), rows))
    return [*head, *parts]


def _absent_structure(cls: type, name: str) -> Any:
    """Defaults of a structure that may be left out, or be listed; otherwise None."""
    for kind in typing.get_args(typing.get_type_hints(cls)[name]):
        if dataclasses.is_dataclass(kind):
            return kind()
    return None


def index_page(pages: list[str]) -> str:
    """Links to all pages."""
    own = [p for p in pages if "/" not in p and p[0].isupper()]
    told = all_messages()
    lines = ["# Reference", "Every message and every behavior, from the code itself."]
    lines += [
        "- [Transitions](transitions.md): which behavior may follow which\n"
        "- [Flags and error codes](flags.md)\n"
        "- [A robot's file](robot.md): every field, with unit and default\n"
        "- [Fields of a scenario](scenario.md), among them every number of the "
        "controller\n"
        "- JSON schemas, with which editors check and complete YAML files: "
        + ", ".join(
            f"[{name}](../schema/{name}.schema.json)"
            for name in ("scenario", "world", "robot", "campaign")
        ),
        "## Behaviors",
        "\n".join(
            f"- [{Path(p).stem}]({p})" for p in pages if p.startswith("behaviors/")
        ),
        "## Messages",
        "\n".join(
            f"- [{Path(p).stem}]({p}): {_first_line(told[Path(p).stem])}" for p in own
        ),
        "## Python",
        "What else can be imported from `atlas_drake`, with the file that explains it. "
        "`make docs` writes a page for every public function and class, with its "
        "arguments, units and errors; open `build/site/index.html`.",
        "\n".join(python_lines()),
    ]
    return "\n\n".join([*lines, NOTE]) + "\n"


def python_lines() -> list[str]:
    """What is importable beside the messages, and what a simulation offers."""
    root = Path(atlas_drake.__file__).parents[1]
    lines = []
    for name in atlas_drake.__all__:
        if name in messages.__all__:
            continue
        value = getattr(atlas_drake, name)
        source = Path(inspect.getsourcefile(value)).relative_to(root)
        lines.append(f"- [{name}](../../{source}): {_first_line(value)}")
        if value is atlas_drake.AtlasSimulation:
            lines += [
                f"    - `{member}`: {_first_line(what)}"
                for member, what in vars(value).items()
                if not member.startswith("_") and what.__doc__
            ]
    return lines


def _first_line(value: Any) -> str:
    return source_docs.head(value.__doc__).split("\n")[0]


def all_pages() -> dict[str, str]:
    """Every page by its path below the reference folder."""
    model = WholeBodyModel(load_robot())
    behaviors = supervisor.Supervisor(model, CONTROLLER, 1.0, BEHAVIORS).behaviors
    pages = {
        f"{name}.md": message_page(name, cls) for name, cls in all_messages().items()
    }
    for behavior, implementation in behaviors.items():
        page = behavior_page(behavior, implementation)
        pages[f"behaviors/{behavior.name}.md"] = page
    pages["transitions.md"] = transitions_page()
    pages["flags.md"] = flags_page()
    pages["robot.md"] = robot_page()
    pages["scenario.md"] = scenario_page()
    pages["README.md"] = index_page(list(pages))
    return pages


def _numbers(cls: type, values: Mapping[str, Any] | None = None) -> str:
    told = source_docs.fields(cls)
    rows = [
        (f"`{name}`", _value(value), told.get(name, ""))
        for name, value in (values or source_docs.defaults(cls)).items()
    ]
    return table(("name", "value", "meaning"), rows)


def _kind(annotation: Any) -> str:
    """A field's type in words that fit into a table."""
    if typing.get_origin(annotation) is typing.Annotated:
        annotation = typing.get_args(annotation)[0]
    if typing.get_origin(annotation) is typing.Union:  # Of annotated types.
        kinds = map(_kind, typing.get_args(annotation))
        return " or ".join(kinds).replace("NoneType", "None")
    # From Python 3.14 on unions have a name too, and it says nothing.
    named = not isinstance(annotation, types.UnionType)
    text = str(getattr(annotation, "__name__", annotation) if named else annotation)
    for numbers in ("float", "int"):
        if text.startswith(f"list[{numbers}] |"):
            return f"list or array of {numbers}"
    return text.replace("|", "or")


def _value(value: Any) -> str:
    if isinstance(value, enum.Enum):
        return str(value.value)
    if isinstance(value, Message):
        return "empty"
    if value is dataclasses.MISSING:
        return "must be given"
    if dataclasses.is_dataclass(value):
        return "see below"
    if value in ("", []):
        return ""
    if isinstance(value, LeastGreatest):
        return f"`{list(value)}`"
    if isinstance(value, list | tuple) and value and isinstance(value[0], Message):
        return f"{len(value)} empty"
    return f"`{value!r}`"
