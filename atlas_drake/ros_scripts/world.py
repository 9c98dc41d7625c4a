"""The environment of a program's code: its builtins, and modules from its own folder.

Only the program and the modules in its folder get the simulated ``time``, the
``threading`` with turns and the builtins of Python 2; Drake, numpy and this package
keep Python's own.
"""

from __future__ import annotations

import builtins
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.machinery import (
    SOURCE_SUFFIXES,
    FileFinder,
    ModuleSpec,
    SourceFileLoader,
)
from pathlib import Path
from types import CodeType, FrameType, ModuleType
from typing import Any

from atlas_drake.ros_scripts.clock import Clock
from atlas_drake.ros_scripts.python2 import BUILTINS, DIVIDE, MATH
from atlas_drake.ros_scripts.source_file import load_program
from atlas_drake.ros_scripts.stand_ins import StandIn
from atlas_drake.ros_scripts.threads import simulated_time, threading_names
from atlas_drake.ros_scripts.unknown import ScriptError

REAL_TIME = {"_thread", "asyncio", "concurrent", "multiprocessing", "queue", "sched"}
"""Modules of Python that wait in other ways than ``time`` and ``threading``."""
_MARK = "__atlas_drake_script__"
"""A name that only the builtins of programs contain."""


def is_in_world(frame: FrameType) -> bool:
    """Tell whether a frame runs code of the program."""
    return _MARK in frame.f_builtins


class World:
    """The environment of one program."""

    def __init__(self, clock: Clock, say: Callable[[str], object]) -> None:
        """Takes time from ``clock``; ``say`` prints notes."""
        self._replaced: dict[str, ModuleType] = {
            "time": simulated_time(clock),
            "threading": StandIn("threading", threading_names(clock)),
        }
        self._say: Callable[[str], object] | None = say

    def run(self, path: Path, code: CodeType, module: ModuleType, *, old: bool) -> None:
        """Runs code as a module.

        Args:
            path: Path of the source file.
            code: Compiled code.
            module: Module that receives the definitions.
            old: True for Python 2.
        """
        names = vars(module)
        names["__file__"] = str(path)
        names["__builtins__"] = self._builtins(old=old)
        exec(code, names)

    def _builtins(self, *, old: bool) -> dict[str, Any]:
        replaced = dict(self._replaced)
        if old:
            replaced |= {"math": _changed(math, MATH), **_old_yaml()}

        def import_(
            name: str,
            globals_: Any = None,
            locals_: Any = None,
            fromlist: Any = (),
            level: int = 0,
        ) -> Any:
            if name in replaced and level == 0:
                return replaced[name]
            if name.partition(".")[0] in REAL_TIME and level == 0:
                raise ScriptError(
                    f"module {name} has no stand-in: its waits would take real time, "
                    "in which the simulation stands still; threading.Thread, Lock, "
                    "RLock and Event wait in simulated time"
                )
            return builtins.__import__(name, globals_, locals_, fromlist, level)

        own = {"__import__": import_, _MARK: True}
        if not old:
            return {**vars(builtins), **own}
        return {**vars(builtins), **BUILTINS, DIVIDE: self._divide, **own}

    def _divide(self, one: Any, other: Any) -> Any:
        """Divides as Python 2; prints a note at the first different result."""
        result = BUILTINS[DIVIDE](one, other)
        say = self._say
        if say is not None and type(result) is int and result * other != one:
            self._say = None
            frame = sys._getframe(1)
            place = f"{Path(frame.f_code.co_filename).name}:{frame.f_lineno}"
            say(
                f"{place}: {one} / {other} is {result}, as in Python 2; "
                "a first line #!/usr/bin/env python3 says that it is not"
            )
        return result


def _changed(module: ModuleType, content: dict[str, Any]) -> ModuleType:
    result = ModuleType(module.__name__, module.__doc__)
    vars(result).update({**vars(module), **content})
    return result


def _old_yaml() -> dict[str, ModuleType]:
    """Return PyYAML, if installed, with a ``load`` that needs no loader."""
    try:
        import yaml
    except ImportError:
        return {}

    def load(stream: Any, Loader: Any = yaml.SafeLoader) -> Any:
        return yaml.load(stream, Loader)

    return {"yaml": _changed(yaml, {"load": load})}


class _Beside:
    """Finds modules in the program's folder."""

    def __init__(self, folder: Path, world: World) -> None:
        self._folder, self._world = folder, world

    def find_spec(
        self, name: str, path: Sequence[str] | None, _target: object = None
    ) -> ModuleSpec | None:
        parent = sys.modules.get(name.rpartition(".")[0])
        if path is not None and not _is_ours(parent):
            # A package from elsewhere, although the folder may contain its files: a
            # virtual environment, or a checkout of this project.
            return None
        for folder in [str(self._folder)] if path is None else path:
            loader = (lambda *a: _Loader(self._world, *a), SOURCE_SUFFIXES)
            spec = FileFinder(folder, loader).find_spec(name)  # type: ignore[arg-type]
            if spec is not None and spec.loader is not None:
                return spec
        return None


class _Loader(SourceFileLoader):
    def __init__(self, world: World, name: str, path: str) -> None:
        super().__init__(name, path)
        self._world = world

    def exec_module(self, module: ModuleType) -> None:
        path = Path(self.path)
        code, is_python2 = load_program(path)
        self._world.run(path, code, module, old=is_python2)


def _is_ours(module: ModuleType | None) -> bool:
    """Tell whether a module came from a program's folder."""
    return isinstance(getattr(module, "__loader__", None), _Loader)


@contextmanager
def as_main(path: Path, arguments: Sequence[str], world: World) -> Iterator[ModuleType]:
    """Makes a program ``__main__``, with its own arguments and folder.

    Args:
        path: Path of the program.
        arguments: Contents of ``sys.argv`` after the program's name.
        world: Environment of the modules in the program's folder.
    """
    main = ModuleType("__main__")
    folder = path.resolve().parent
    finder = _Beside(folder, world)
    before = sys.argv, list(sys.path), sys.modules["__main__"], set(sys.modules)
    sys.argv = [str(path), *arguments]
    sys.path.insert(0, str(folder))
    sys.modules["__main__"] = main
    sys.meta_path.insert(0, finder)
    try:
        yield main
    finally:
        sys.meta_path.remove(finder)
        sys.argv, sys.path[:], sys.modules["__main__"], known = before
        for name in set(sys.modules) - known:
            if _is_ours(sys.modules[name]):
                del sys.modules[name]
