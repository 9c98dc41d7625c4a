"""The environment of a program's code: stand-ins, builtins, modules from its folder.

The contents of the modules that stand in for those of ROS are in the other files of
this folder; a missing name raises an error that lists the names of the module. Only the
program and the modules in its folder get the simulated ``time``, the ``threading`` with
turns and the builtins of Python 2; Drake, numpy and this package keep Python's own.
"""

from __future__ import annotations

import builtins
import select
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from importlib.machinery import SOURCE_SUFFIXES, FileFinder, SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any, TextIO, cast

from atlas_drake.clients.ros_scripts import poses
from atlas_drake.clients.ros_scripts.clock import Clock
from atlas_drake.clients.ros_scripts.keyboard import Keyboard
from atlas_drake.clients.ros_scripts.message_types import PACKAGES, with_joints_of
from atlas_drake.clients.ros_scripts.python2 import load_program
from atlas_drake.clients.ros_scripts.python2_values import (
    BUILTINS,
    DIVIDE,
    divide,
    old_modules,
    with_names,
)
from atlas_drake.clients.ros_scripts.ros_types import std_srvs
from atlas_drake.clients.ros_scripts.threads import simulated_threading, simulated_time
from atlas_drake.clients.ros_scripts.unknown import (
    ScriptError,
    UnknownNameError,
    unknown,
)
from atlas_drake.robot import Robot

REAL_TIME = {"_thread", "asyncio", "concurrent", "multiprocessing", "queue", "sched"}
"""Modules of Python that wait in other ways than ``time`` and ``threading``."""


class StandIn(ModuleType):
    """A module whose errors list its names."""

    def __init__(self, name: str, content: Mapping[str, Any]) -> None:
        """Makes a module with ``content``, by name."""
        super().__init__(name, f"Stands in for the module {name}.")
        self.__path__: list[str] = []
        self.names = sorted(content)
        self.__all__ = self.names
        vars(self).update(content)

    def __getattr__(self, name: str) -> Any:
        # Python itself looks up such names.
        if name.startswith("__"):
            raise AttributeError(name)
        what = f"{self.__name__}.{name}"
        raise unknown(what, name, self.names, UnknownNameError)


def stand_ins(
    per_run: Mapping[str, Mapping[str, Any]], robot: Robot
) -> dict[str, StandIn]:
    """Return all modules of ROS by full name.

    Args:
        per_run: Contents of the modules that a run has for itself, such as ``rospy``.
        robot: The robot, whose joints ``AtlasState`` names.
    """
    contents: dict[str, Mapping[str, Any]] = {
        **per_run,
        "PyKDL": poses.KDL,
        "roslib": {"load_manifest": lambda *_packages: None},
        "std_srvs": {},
        "std_srvs.srv": std_srvs,
        "tf": {},
        "tf.transformations": poses.TRANSFORMATIONS,
        "tf_conversions": poses.POSEMATH,
        "tf_conversions.posemath": poses.POSEMATH,
    }
    for package, types in PACKAGES.items():
        own = with_joints_of(robot, types) if "AtlasState" in types else types
        contents |= {package: {}, f"{package}.msg": own}
    modules: dict[str, StandIn] = {}
    for name in sorted(contents):  # Packages come before their modules.
        modules[name] = StandIn(name, contents[name])
        package, _, last = name.rpartition(".")
        if package:
            setattr(modules[package], last, modules[name])
            modules[package].names.append(last)
    return modules


class World:
    """The environment of one program; ``folders`` are those whose modules share it."""

    def __init__(self, folder: Path, clock: Clock, say: Callable[[str], object]):
        """Takes time from ``clock``; ``say`` prints notes."""
        self.folders = {str(folder)}
        self.keyboard = Keyboard(clock, sys.stdin)
        self._modules: dict[str, ModuleType] = {
            "time": simulated_time(clock),
            "threading": StandIn("threading", simulated_threading(clock)),
            "select": with_names(select, {"select": self.keyboard.select}),
        }
        self._say: Callable[[str], object] | None = say

    def run(self, path: Path, code: CodeType, module: ModuleType, *, old: bool) -> None:
        """Runs code, in Python 2 if it is ``old``, as a module."""
        modules = self._modules | (old_modules() if old else {})
        names = vars(module)
        names["__file__"] = str(path)
        names["__builtins__"] = {
            **vars(builtins),
            **({**BUILTINS, DIVIDE: self._divide} if old else {}),
            "__import__": partial(_import, modules),
            "input": self.keyboard.input,
        }
        exec(code, names)

    def _divide(self, one: Any, other: Any) -> Any:
        """Divides as Python 2; prints a note at the first different result."""
        result = divide(one, other)
        if self._say and type(result) is int and result * other != one:
            frame = sys._getframe(1)
            self._say(
                f"{Path(frame.f_code.co_filename).name}:{frame.f_lineno}: {one} / "
                f"{other} is {result}, as in Python 2; a first line "
                "#!/usr/bin/env python3 says that it is not"
            )
            self._say = None
        return result


def _import(
    modules: Mapping[str, ModuleType],
    name: str,
    globals_: Any = None,
    locals_: Any = None,
    fromlist: Any = (),
    level: int = 0,
) -> Any:
    """``__import__`` of a program, with other ``modules`` than Python's."""
    package = name.partition(".")[0]
    if level == 0 and (name in modules or (package in modules and not fromlist)):
        builtins.__import__(name)
        return modules[package]
    if level == 0 and package in REAL_TIME:
        raise ScriptError(
            f"module {name} has no stand-in: its waits would take real time, in which "
            "the simulation stands still; Thread, Lock, RLock and Event of threading "
            "wait in simulated time"
        )
    return builtins.__import__(name, globals_, locals_, fromlist, level)


class _Loader(SourceFileLoader):
    """Loads a module from a program's folder into its world."""

    def __init__(self, world: World, name: str, path: str) -> None:
        super().__init__(name, path)
        self._world = world

    def exec_module(self, module: ModuleType) -> None:
        self._world.folders |= set(getattr(module, "__path__", ()))
        path = Path(self.path)
        code, is_python2 = load_program(path)
        self._world.run(path, code, module, old=is_python2)


@contextmanager
def as_main(
    path: Path,
    arguments: Sequence[str],
    world: World,
    modules: Mapping[str, ModuleType],
) -> Iterator[ModuleType]:
    """Makes a program ``__main__``, with its own arguments, folder and modules."""

    def find_in_world(entry: str) -> FileFinder:
        if entry not in world.folders:
            raise ImportError
        loader: Any = partial(_Loader, world)
        return FileFinder(entry, (loader, SOURCE_SUFFIXES))

    folder = str(path.resolve().parent)
    before = sys.argv, sys.stdin, list(sys.path), dict(sys.modules)
    main = ModuleType("__main__")
    sys.argv = [str(path), *arguments]
    sys.stdin = cast(TextIO, world.keyboard)
    sys.path.insert(0, folder)
    sys.path_hooks.insert(0, find_in_world)
    sys.path_importer_cache.pop(folder, None)
    sys.modules.update({**modules, "__main__": main})
    try:
        yield main
    finally:
        sys.path_hooks.remove(find_in_world)
        sys.argv, sys.stdin, sys.path[:], known = before
        for entry in world.folders:
            sys.path_importer_cache.pop(entry, None)
        for name, module in list(sys.modules.items()):
            of_program = isinstance(getattr(module, "__loader__", None), _Loader)
            if of_program or name in modules:
                del sys.modules[name]
        for name in {*modules, "__main__"} & set(known):
            sys.modules[name] = known[name]
