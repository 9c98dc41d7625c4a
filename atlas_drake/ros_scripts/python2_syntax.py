"""Translates syntax that Python 3 cannot read, such as ``print`` without parentheses.

This needs fissix, the maintained copy of lib2to3, which was in the standard library.
Without it the program is refused, and the error names the line. Differences in meaning
are in ``python2``.
"""

from __future__ import annotations

import re
from pathlib import Path

from atlas_drake.ros_scripts.unknown import ScriptError

FIXERS = (
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
TAB = 8
"""Columns of a tab in Python 2."""


def as_python3(path: Path, source: str, error: SyntaxError) -> str:
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
        r"^[ \t]*\t[ \t]*", lambda found: found[0].expandtabs(TAB), source, flags=re.M
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
    tool = RefactoringTool([f"fissix.fixes.fix_{name}" for name in FIXERS])
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
