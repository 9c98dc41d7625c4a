"""Worlds as data: what stands around the robot and where the robot starts, from YAML.

One file per world: those in ``models/worlds`` are known by name, any other one by its
path. What callables add to a plant is in ``world``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from atlas_drake.config import (
    Configuration,
    Vector,
    as_plain,
    checked,
    fields_of,
    overlaid,
    read_fields,
    read_file,
)
from atlas_drake.errors import ScenarioError
from atlas_drake.robot.load import (
    MODELS_FOLDER,
    file_beside,
    find_data_file,
    model_beside,
    names_in,
)
from atlas_drake.units import Meters, Radians
from atlas_drake.worlds.models import Model
from atlas_drake.worlds.obstacles import Blocks, Ramp, Rubble, Stairs
from atlas_drake.worlds.terrain import Block, Place

WORLDS_FOLDER = MODELS_FOLDER / "worlds"
DEFAULT_WORLD = "level"


@dataclass(frozen=True)
class WorldStart(Configuration):
    """Start of the robot in a world; ``start`` of the scenario overrides it."""

    position: Place = field(default_factory=lambda: [0.0, 0.0])
    """Position of the pelvis along x and y in W."""
    yaw: Radians = 0.0
    """Heading of the pelvis in W."""


@dataclass(frozen=True)
class View(Configuration):
    """Initial camera of the 3D view, and camera of a film."""

    lens: Vector[Meters] = field(default_factory=lambda: [3.3, -2.5, 1.45])
    """Position of the camera in W."""
    target: Vector[Meters] = field(default_factory=lambda: [0.2, 0.0, 0.98])
    """Point that the camera looks at in W."""

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
    rubble: Rubble | None = None
    """Bricks at random."""

    def terrain(self) -> list[Block]:
        """Returns all boxes, those of obstacles included."""
        obstacles = [self.stairs, self.ramp, self.blocks, self.rubble]
        given = [one for one in obstacles if one is not None]
        return [*self.boxes, *(block for one in given for block in one.blocks())]


def available_worlds() -> list[str]:
    """Lists the names of the worlds in the package, the default first."""
    return names_in(WORLDS_FOLDER, DEFAULT_WORLD)


def with_full_paths(raw: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Makes the paths in the fields of a scenario or a world absolute from a folder."""
    seen = dict(raw)
    model, world, models = map(raw.get, ("model", "world", "models"))
    if "policy" in raw:
        seen["policy"] = _with_full_path(raw["policy"], folder)
    if isinstance(model, str):
        seen["model"] = model_beside(model, folder)
    if isinstance(world, str):
        world = {"name": world}
    if isinstance(world, Mapping):
        seen["world"] = with_full_paths(world, folder)
        if isinstance(name := world.get("name"), str):
            seen["world"]["name"] = file_beside(name, folder, available_worlds())
    if isinstance(models, list):
        seen["models"] = [_with_full_path(one, folder) for one in models]
    return seen


def _with_full_path(named: Any, folder: Path) -> Any:
    file = named.get("file") if isinstance(named, Mapping) else None
    if not isinstance(file, str) or not file or "://" in file:
        return named
    return {**named, "file": str((folder / file).absolute())}


def load_world(name: str | Path = DEFAULT_WORLD) -> World:
    """Reads one world."""
    names = available_worlds()
    path = find_data_file(name, WORLDS_FOLDER, names, "world", ScenarioError)
    try:
        raw = read_fields(read_file(path), "boxes: []")
        if "name" in raw:
            problem = "is not for the file: the file's own name is it"
            raise ScenarioError("world.name", raw["name"], problem)
        known = str(name) if str(name) in names else str(path)
        raw = with_full_paths(raw, path.parent) | {"name": known}
        world: World = checked(World, raw, "world")
    except ScenarioError as error:
        raise error.within(path) from None
    return world


def world_fields(given: Any) -> dict[str, Any]:
    """Returns the fields of the world that a scenario gives as a text or as fields.

    A text is the ``name`` alone. A named world also has the fields of its file. A world
    from a log has all fields, so that its file is not needed.
    """
    plain = as_plain({"name": given} if isinstance(given, str) else given)
    if not isinstance(plain, dict):
        problem = "must be a world's name, the path of its file, or fields"
        raise ScenarioError.about("world", given, problem)
    name = plain.get("name")
    if not isinstance(name, str) or fields_of(World).keys() <= plain.keys():
        return plain
    known = as_plain(load_world(name))
    named: dict[str, Any] = overlaid(known, {**plain, "name": known["name"]})
    return named
