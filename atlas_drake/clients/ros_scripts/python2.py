"""Reads a program's file, and gives a Python 2 program its meaning.

A program whose first line names python3 is Python 3; any other program is Python 2,
which was current at the time of DRCSim. fissix, the maintained copy of lib2to3,
translates it. What depends on the types of values is in ``python2_values``.
"""

from __future__ import annotations

import ast
import functools
import re
import tokenize
from pathlib import Path
from types import CodeType
from typing import Any

from atlas_drake.clients.ros_scripts.python2_values import DIVIDE, DIVIDE_IN_PLACE
from atlas_drake.clients.ros_scripts.unknown import ScriptError

_PYTHON3 = re.compile(r"#!.*\bpython3")
_NOT_FIXED = {
    *("future", "import"),
    *("exitfunc", "intern", "operator", "reduce", "reload", "sorted"),
}
"""Fixers of fissix about packages, and those that add lines, which errors name."""
_TAB = 8
"""Columns of a tab in Python 2."""


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
