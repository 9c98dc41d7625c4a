"""Reads, translates and compiles a program's file.

A program whose first line names python3 is Python 3; any other program is Python 2,
which was current at the time of DRCSim. Syntax that Python 3 cannot read, such as
``print`` without parentheses, is translated by fissix, the maintained copy of lib2to3.
Differences in meaning are in ``python2``.
"""

from __future__ import annotations

import ast
import re
import tokenize
from pathlib import Path
from types import CodeType

from atlas_drake.ros_scripts.python2 import old_meaning
from atlas_drake.ros_scripts.unknown import ScriptError

_PYTHON3 = re.compile(r"#!.*\bpython3")
_FIXERS = (
    "except",
    "exec",
    "ne",
    "numliterals",
    "paren",
    "print",
    "raise",
    "repr",
    "tuple_params",
    "unicode",
)
"""Fixers for syntax alone; the rest of a program stays as it is."""
_TAB = 8
"""Columns of a tab in Python 2."""


def load_program(path: Path) -> tuple[CodeType, bool]:
    """Reads and compiles a program.

    Returns:
        The code of the program, and True if it is taken for Python 2.

    Raises:
        ScriptError: If the file cannot be read, or is not valid Python; the error names
            the line.
    """
    try:
        with tokenize.open(path) as file:
            source = file.read()
    except (OSError, SyntaxError, UnicodeDecodeError) as error:
        problem = getattr(error, "strerror", None) or error
        raise ScriptError(f"{path}: cannot be read: {problem}") from error
    is_python2 = _PYTHON3.match(source) is None
    try:
        tree = _tree(path, source, is_python2)
        return compile(tree, str(path), "exec", dont_inherit=True), is_python2
    except SyntaxError as error:
        raise ScriptError(f"{path}:{error.lineno}: {error.msg}") from error
    except ValueError as error:  # Null bytes.
        raise ScriptError(f"{path}: {error}") from error


def _tree(path: Path, source: str, is_python2: bool) -> ast.Module:
    """Parses a program and gives a Python 2 one its meaning.

    Raises:
        SyntaxError: If it is not valid Python.
    """
    try:
        tree = ast.parse(source, str(path))
    except SyntaxError as error:
        if not is_python2:
            raise
        tree = ast.parse(_as_python3(path, source, error), str(path))
    return old_meaning(tree) if is_python2 else tree


def _as_python3(path: Path, source: str, error: SyntaxError) -> str:
    """Return a program's text in Python 3, with the same lines.

    Args:
        path: Path of the program, for errors.
        source: Text of the program.
        error: Error of Python 3.

    Raises:
        ScriptError: If fissix is needed and not installed, or the program is not
            Python 2 either.
    """
    source = re.sub(
        r"^[ \t]*\t[ \t]*", lambda found: found[0].expandtabs(_TAB), source, flags=re.M
    )
    try:
        compile(source, str(path), "exec", dont_inherit=True)
        return source
    except SyntaxError:
        pass
    where = f"{path}:{error.lineno}: {error.msg}"
    try:
        from fissix.pgen2.parse import ParseError
        from fissix.pgen2.tokenize import TokenError
        from fissix.refactor import RefactoringTool
    except ImportError as missing:
        raise ScriptError(
            f"{where}. If this is Python 2, `pip install 'atlas-drake[scripts]'` lets "
            "it be read; or write print(...) with parentheses and `except X as e`"
        ) from missing
    tool = RefactoringTool([f"fissix.fixes.fix_{name}" for name in _FIXERS])
    try:
        # The grammar of fissix needs a newline at the end.
        return str(tool.refactor_string(source.rstrip() + "\n", str(path)))
    except (ParseError, TokenError, IndentationError) as problem:
        line = _line_of(problem)
        raise ScriptError(
            f"{where}; read as Python 2, the program is invalid at line {line}"
        ) from problem


def _line_of(problem: Exception) -> int:
    """Returns the line at which fissix could not go on."""
    if isinstance(problem, SyntaxError):
        return problem.lineno or 1
    # A ParseError has (prefix, (line, column)) as its context, a TokenError
    # (text, (line, column)) as its arguments.
    where = getattr(problem, "context", problem.args)
    return int(where[1][0])
