"""Reads a program's file, and gives a Python 2 program its meaning.

A program whose first line names python3 is Python 3; any other program is Python 2,
which was current at the time of DRCSim. fissix, the maintained copy of lib2to3,
translates it; only what depends on the types of values is done here: ``/`` of whole
numbers, functions that returned floats, and functions that took them for whole numbers.
"""

from __future__ import annotations

import ast
import functools
import math
import re
import tokenize
from collections.abc import Callable
from numbers import Integral
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import numpy

from atlas_drake.ros_scripts.unknown import ScriptError

_PYTHON3 = re.compile(r"#!.*\bpython3")
_NOT_FIXED = {
    *("future", "import"),
    *("exitfunc", "intern", "operator", "reduce", "reload", "sorted"),
}
"""Fixers of fissix about packages, and those that add lines, which errors name."""
_TAB = 8
"""Columns of a tab in Python 2."""
DIVIDE, DIVIDE_IN_PLACE = "__python2_div__", "__python2_idiv__"
"""Names of the functions for ``/`` and ``/=`` in the program's builtins."""


def load_program(path: Path) -> tuple[CodeType, bool]:
    """Reads and compiles a program; returns its code, and True if it is Python 2."""
    try:
        with tokenize.open(path) as file:
            source = file.read()
        is_python2 = _PYTHON3.match(source) is None
        if is_python2:
            tree = _with_old_division(ast.parse(_as_python3(source), str(path)))
        else:
            tree = ast.parse(source, str(path))
        return compile(tree, str(path), "exec", dont_inherit=True), is_python2
    except SyntaxError as error:
        raise ScriptError(f"{path}:{error.lineno}: {error.msg}") from error
    except (OSError, ValueError) as error:  # A ValueError is of bytes or encoding.
        problem = getattr(error, "strerror", None) or error
        raise ScriptError(f"{path}: cannot be read: {problem}") from error


def _as_python3(source: str) -> str:
    """Translates a Python 2 program, whose lines stay where they are."""
    tabs = re.compile(r"^[ \t]*\t[ \t]*", re.MULTILINE)
    source = tabs.sub(lambda found: found[0].expandtabs(_TAB), source)
    try:
        ast.parse(source)
        error = None
    except SyntaxError as problem:
        error = problem
    try:
        from fissix.pgen2.parse import ParseError
        from fissix.pgen2.tokenize import TokenError
    except ImportError as missing:
        if error is None:
            return source
        error.msg += (
            ". If this is Python 2, `pip install 'atlas-drake[scripts]'` lets it be "
            "read; or write print(...) with parentheses and `except X as e`"
        )
        raise error from missing
    # What Python 3 can read has no print statement.
    tool = _translator(has_print_statement=error is not None)
    try:
        # The grammar of fissix needs a newline at the end.
        return str(tool.refactor_string(source.rstrip() + "\n", "program"))
    except (ParseError, TokenError, IndentationError) as problem:
        if error is None:
            return source
        error.msg += f"; read as Python 2: {problem}"
        raise error from problem


@functools.cache
def _translator(*, has_print_statement: bool) -> Any:
    from fissix.refactor import RefactoringTool, get_fixers_from_package

    left_out = _NOT_FIXED if has_print_statement else {*_NOT_FIXED, "print"}
    fixers = [
        name
        for name in get_fixers_from_package("fissix.fixes")
        if name.rpartition("fix_")[2] not in left_out
    ]
    return RefactoringTool(fixers, {"print_function": not has_print_statement})


def _with_old_division(tree: ast.Module) -> ast.Module:
    """Replaces ``/`` by a function, unless ``division`` comes from ``__future__``."""
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    if any(name.name == "division" for node in imports for name in node.names):
        return tree
    result: ast.Module = _OldDivision().visit(tree)
    return ast.fix_missing_locations(result)


class _OldDivision(ast.NodeTransformer):
    """Replaces divisions by calls of the functions in ``BUILTINS``."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        if not isinstance(node.op, ast.Div):
            return node
        return self._call(node, DIVIDE, node.left, node.right)

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.AST:
        self.generic_visit(node)
        if not isinstance(node.op, ast.Div):
            return node
        # The target once more, as an expression to read.
        target = ast.parse(ast.unparse(node.target), mode="eval").body
        value = self._call(node, DIVIDE_IN_PLACE, target, node.value)
        return ast.copy_location(ast.Assign([node.target], value), node)

    def _call(self, node: ast.AST, name: str, *arguments: ast.expr) -> ast.Call:
        function = ast.Name(name, ast.Load())
        return ast.copy_location(ast.Call(function, list(arguments), []), node)


def divide(one: Any, other: Any) -> Any:
    """``/`` of Python 2."""
    return one // other if _whole(one) and _whole(other) else one / other


def _divide_in_place(one: Any, other: Any) -> Any:
    if _whole(one) and _whole(other):
        one //= other
    else:
        one /= other
    return one


def _whole(value: Any) -> bool:
    kind = getattr(getattr(value, "dtype", None), "kind", "no array")
    return isinstance(value, Integral) or kind in ("i", "u")


def _round(number: float, digits: int = 0) -> float:
    """Round halves away from zero; return a float."""
    scale = 10.0**digits
    return math.copysign(math.floor(abs(number) * scale + 0.5) / scale, number)


def _as_whole(value: Any) -> Any:
    """Return whole floats as integers, also those in a shape of several."""
    if isinstance(value, tuple | list):
        return [_as_whole(part) for part in value]
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _counting(function: Callable[..., Any], place: int, name: str) -> Any:
    """Return a function that takes a whole float as its count or shape.

    The argument has a ``place`` among those by position, and a ``name``.
    """

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        given = list(arguments)
        given[place : place + 1] = map(_as_whole, given[place : place + 1])
        if name in named:
            named[name] = _as_whole(named[name])
        return function(*given, **named)

    return call


BUILTINS: dict[str, Any] = {
    DIVIDE: divide,
    DIVIDE_IN_PLACE: _divide_in_place,
    "cmp": lambda one, other: (one > other) - (one < other),
    "file": open,
    "range": lambda *limits: range(*map(_as_whole, limits)),
    "reduce": functools.reduce,
    "round": _round,
}
"""Builtins of Python 2 that fissix does not translate."""

NUMPY_COUNTS = {
    **dict.fromkeys(("empty", "ones", "zeros"), (0, "shape")),
    "eye": (0, "N"),
    "identity": (0, "n"),
    "linspace": (2, "num"),
}
"""Functions of numpy that took whole floats: place and name of that argument."""


def old_modules() -> dict[str, ModuleType]:
    """Return ``math``, ``numpy`` and, if installed, ``yaml`` as they were."""
    changed = {
        "ceil": lambda number: float(math.ceil(number)),
        "floor": lambda number: float(math.floor(number)),
    }
    counting = {
        name: _counting(getattr(numpy, name), place, argument)
        for name, (place, argument) in NUMPY_COUNTS.items()
    }
    types = {kind.__name__: kind for kind in (bool, float, int)}
    modules = {
        "math": with_names(math, changed),
        "numpy": with_names(numpy, counting | types),
    }
    try:
        import yaml
    except ImportError:
        return modules

    def load(stream: Any, Loader: Any = yaml.SafeLoader) -> Any:
        return yaml.load(stream, Loader)

    return modules | {"yaml": with_names(yaml, {"load": load})}


def with_names(module: ModuleType, names: dict[str, Any]) -> ModuleType:
    """Return a copy of a module in which some names have another meaning."""
    result = ModuleType(module.__name__, module.__doc__)
    vars(result).update({**vars(module), **names})
    return result
