"""Worlds as data: what stands around the robot and where the robot starts, from YAML.

One file per world: those in ``models/worlds`` are known by name, any other one by its
path. What callables add to a plant is in ``world``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from atlas_drake.config import Configuration, Vector, checked, read_yaml
from atlas_drake.errors import ScenarioError, shown
from atlas_drake.robot.data_file import file_beside, find_data_file
from atlas_drake.robot.load import MODELS_FOLDER
from atlas_drake.scenario.models import Model, models_beside
from atlas_drake.scenario.obstacles import Blocks, Ramp, Stairs, Strewn
from atlas_drake.scenario.terrain import Block, Place

WORLDS_FOLDER = MODELS_FOLDER / "worlds"
DEFAULT_WORLD = "level"
_OBSTACLES = ("stairs", "ramp", "blocks", "strewn")


@dataclass(frozen=True)
class WorldStart(Configuration):
    """Start of the robot in a world; ``start`` of the scenario overrides it."""

    position: Place = field(default_factory=lambda: [0.0, 0.0])
    """Position of the pelvis along x and y in W [m]."""
    yaw: float = 0.0
    """Heading of the pelvis in W [rad]."""


@dataclass(frozen=True)
class View(Configuration):
    """Initial camera of the 3D view, and camera of a film."""

    lens: Vector = field(default_factory=lambda: [3.3, -2.5, 1.45])
    """Position of the camera in W [m]."""
    target: Vector = field(default_factory=lambda: [0.2, 0.0, 0.98])
    """Point that the camera looks at in W [m]."""

    def check(self) -> None:
        """Checks that the camera looks at something."""
        if self.lens == self.target:
            raise ScenarioError("lens", self.lens, "must be elsewhere than the target")


@dataclass(frozen=True)
class World(Configuration):
    """What there is beside the robot on the level ground at z = 0.

    A scenario has a world's name, the path of its file, or fields: ``name`` says whose
    values those have that are left out.
    """

    name: str = DEFAULT_WORLD
    """A name from ``models/worlds``, or the path of a world's YAML file."""
    description: str = ""
    """Contents in a few words, for ``--help``."""
    start: WorldStart = field(default_factory=WorldStart)
    """Start of the robot."""
    view: View | None = None
    """Initial camera of the 3D view, and camera of a film; null for one in front of
    the robot."""
    boxes: list[Block] = field(default_factory=list)
    """Boxes that do not move, as a scenario's ``terrain``."""
    models: list[Model] = field(default_factory=list)
    """Models from files, as a scenario's ``models``; their paths are relative to the
    world's file."""
    stairs: Stairs | None = None
    """A flight of steps."""
    ramp: Ramp | None = None
    """A slope."""
    blocks: Blocks | None = None
    """Tilted footholds."""
    strewn: Strewn | None = None
    """Bricks at random."""

    def terrain(self) -> list[Block]:
        """Return all boxes, those of obstacles included."""
        obstacles = [getattr(self, name) for name in _OBSTACLES]
        given = [one for one in obstacles if one is not None]
        return [*self.boxes, *(block for one in given for block in one.blocks())]


def available_worlds() -> list[str]:
    """Names of the worlds that come with the package, the default first."""
    names = sorted(path.stem for path in WORLDS_FOLDER.glob("*.yaml"))
    return sorted(names, key=lambda name: name != DEFAULT_WORLD)


def find_world(name: str | Path) -> Path:
    """Return the YAML file of a world, absolute.

    Args:
        name: From ``available_worlds``, or the path of a YAML file, relative to the
            working folder.

    Raises:
        ScenarioError: If there is no such world.
    """
    return find_data_file(
        name,
        WORLDS_FOLDER,
        available_worlds(),
        "world",
        lambda problem: ScenarioError("world", str(name), problem),
    )


def world_beside(world: Any, folder: Path) -> Any:
    """Return what a scenario's file says of its world, with paths from ``folder``."""
    if isinstance(world, Mapping):
        fields_given = {**world, "models": models_beside(world.get("models"), folder)}
        fields_given = {name: fields_given[name] for name in world}
        if "name" in world:
            fields_given["name"] = world_beside(world["name"], folder)
        return fields_given
    if not isinstance(world, str):
        return world
    return file_beside(world, folder, available_worlds())


def load_world(name: str | Path = DEFAULT_WORLD) -> World:
    """Read one world.

    Args:
        name: As for ``find_world``.

    Raises:
        ScenarioError: If there is no such world, or its file is faulty.
    """
    path = find_world(name)
    try:
        return _load(path, str(name) if str(name) in available_worlds() else str(path))
    except ScenarioError as error:
        raise error.within(path) from None


def world_from(given: Any, present: World | None = None) -> World:
    """Make a world of what a scenario has in its field ``world``.

    Args:
        given: A ``World``; a name or a path; or a mapping of fields, of which ``name``
            says whose values the fields left out have.
        present: Has the fields left out where no name is given; None is level ground.

    Raises:
        ScenarioError: Naming the first field that cannot be used.
    """
    if isinstance(given, World):
        return given
    if isinstance(given, str | Path):
        return load_world(given)
    if not isinstance(given, Mapping):
        raise ScenarioError(
            "world",
            given,
            f"is {shown(given)}; must be a world's name, such as {DEFAULT_WORLD}, the "
            "path of its file, or fields such as {name: stairs}",
        )
    base = World() if present is None else present
    # A log has all fields: such a world does not need the file that it came from.
    if "name" in given and not {one.name for one in fields(World)} <= set(given):
        name = given["name"]
        if not isinstance(name, str | Path):
            raise ScenarioError("world.name", name, f"is {shown(name)}; must be a word")
        base = load_world(name)
        given = {**given, "name": base.name}
    world: World = checked(World, given, "world", base=base, from_text=True)
    return world


def _load(path: Path, name: str) -> World:
    try:
        text = path.read_text()
        raw = read_yaml(text) if text.strip() else None
    except Exception as error:
        # The parser raises many kinds of exception for what is always a faulty file.
        raise ScenarioError("world", str(path), f"cannot be read: {error}") from error
    if not isinstance(raw, Mapping):
        raise ScenarioError(
            "world", raw, "must have fields of a world, such as boxes: []"
        )
    if "name" in raw:
        raise ScenarioError(
            "world.name", raw["name"], "is not for the file: the file's own name is it"
        )
    if "models" in raw:
        raw = {**raw, "models": models_beside(raw["models"], path.parent)}
    world: World = checked(World, {**raw, "name": name}, "world", from_text=True)
    return world
