"""Reads, translates and compiles a program's file.

A program whose first line names python3 is Python 3; any other program is Python 2,
which was current at the time of DRCSim.
"""

from __future__ import annotations

import ast
import re
import tokenize
from pathlib import Path
from types import CodeType

from atlas_drake.ros_scripts.python2 import old_meaning
from atlas_drake.ros_scripts.python2_syntax import as_python3
from atlas_drake.ros_scripts.unknown import ScriptError

_PYTHON3 = re.compile(r"#!.*\bpython3")


def is_python2(source: str) -> bool:
    """Tell whether a program is taken for Python 2."""
    return _PYTHON3.match(source) is None


def read_source(path: Path) -> str:
    """Return a program's text.

    Raises:
        ScriptError: If it cannot be read.
    """
    try:
        with tokenize.open(path) as file:
            return file.read()
    except (OSError, SyntaxError, UnicodeDecodeError) as error:
        problem = getattr(error, "strerror", None) or error
        raise ScriptError(f"{path}: cannot be read: {problem}") from error


def compile_program(path: Path, source: str) -> CodeType:
    """Return the code of a program.

    Raises:
        ScriptError: If it is not valid Python; the error names the line.
    """
    old = is_python2(source)
    try:
        tree = _parse(path, source)
    except SyntaxError as error:
        if not old:
            raise ScriptError(f"{path}:{error.lineno}: {error.msg}") from error
        try:
            tree = _parse(path, as_python3(path, source, error))
        except SyntaxError as second:
            raise ScriptError(f"{path}:{second.lineno}: {second.msg}") from second
    except ValueError as error:  # Null bytes.
        raise ScriptError(f"{path}: {error}") from error
    if old:
        try:
            tree = old_meaning(tree)
        except SyntaxError as error:
            raise ScriptError(f"{path}:{error.lineno}: {error.msg}") from error
    return compile(tree, str(path), "exec", dont_inherit=True)


def _parse(path: Path, source: str) -> ast.Module:
    return ast.parse(source, str(path))
