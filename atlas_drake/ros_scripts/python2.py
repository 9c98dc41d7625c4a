"""Operators, methods and builtins whose meaning differs between Python 2 and 3.

Programs for ROS 1 and DRCSim were written for Python 2, in which ``1 / 2`` is 0 and
``range(3)`` is a list. ``old_meaning`` rewrites operators and methods in the syntax
tree; ``BUILTINS`` has the functions. ``source_file`` translates what Python 3 cannot
read.
"""

from __future__ import annotations

import ast
import builtins
import functools
import math
from collections.abc import Callable
from numbers import Integral
from typing import Any

DIVIDE, DIVIDE_IN_PLACE = "__python2_div__", "__python2_idiv__"
"""Names of the functions for ``/`` and ``/=`` in the program's builtins."""
METHOD = "__python2_method__"
"""Name of the function that looks up methods that Python 3 lacks or changed."""


class WholeFloat(float):
    """A float that may be used as an index, as in Python 2."""

    def __index__(self) -> int:
        return int(self)


def _divide(one: Any, other: Any) -> Any:
    return one // other if _whole(one) and _whole(other) else one / other


def _divide_in_place(one: Any, other: Any) -> Any:
    if _whole(one) and _whole(other):
        one //= other
    else:
        one /= other
    return one


def _whole(value: Any) -> bool:
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    return isinstance(value, Integral) or (bool(kind) and kind in "iu")


_METHODS: dict[str, Callable[..., Any]] = {
    "has_key": lambda mapping, key: key in mapping,
    "iteritems": lambda mapping: iter(mapping.items()),
    "iterkeys": iter,
    "itervalues": lambda mapping: iter(mapping.values()),
    "next": next,
}
"""Methods that Python 3 lacks."""
_LISTS = ("keys", "values", "items")
"""Methods of dictionaries that returned lists."""


def _method(owner: Any, name: str) -> Any:
    """Return ``owner.name`` as in Python 2."""
    if name in _LISTS and isinstance(owner, dict):
        return lambda: list(getattr(owner, name)())
    if name in _METHODS and not hasattr(owner, name):
        return functools.partial(_METHODS[name], owner)
    return getattr(owner, name)


def _filter(function: Callable[..., Any] | None, values: Any) -> Any:
    """Filter; return a string of a string, a tuple of a tuple, else a list."""
    kept = list(builtins.filter(function, values))
    if isinstance(values, str):
        return "".join(kept)
    return tuple(kept) if isinstance(values, tuple) else kept


def _listed(function: Callable[..., Any]) -> Callable[..., list[Any]]:
    return lambda *arguments: list(function(*arguments))


def _round(number: float, digits: int = 0) -> float:
    """Round halves away from zero; return a float."""
    scale = 10.0**digits
    return WholeFloat(
        math.copysign(math.floor(abs(number) * scale + 0.5) / scale, number)
    )


BUILTINS: dict[str, Any] = {
    DIVIDE: _divide,
    DIVIDE_IN_PLACE: _divide_in_place,
    METHOD: _method,
    "basestring": str,
    "cmp": lambda one, other: (one > other) - (one < other),
    "file": open,
    "filter": _filter,
    "input": lambda *prompt: eval(input(*prompt), {}),
    "long": int,
    "map": _listed(builtins.map),
    "range": _listed(builtins.range),
    "raw_input": input,
    "reduce": functools.reduce,
    "round": _round,
    "unicode": str,
    "xrange": range,
    "zip": _listed(builtins.zip),
}
"""Builtins of Python 2 that Python 3 lacks or changed."""

MATH: dict[str, Any] = {
    "ceil": lambda number: WholeFloat(math.ceil(number)),
    "floor": lambda number: WholeFloat(math.floor(number)),
}
"""Functions of ``math`` that returned floats."""


class _OldMeaning(ast.NodeTransformer):
    """Replaces operators and methods by calls of the functions above."""

    def __init__(self, *, division: bool) -> None:
        self._division = division
        self._leaks = True

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        if not (self._division and isinstance(node.op, ast.Div)):
            return node
        return self._call(node, DIVIDE, node.left, node.right)

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.AST:
        self.generic_visit(node)
        if not (self._division and isinstance(node.op, ast.Div)):
            return node
        # The target once more, as an expression to read.
        place = ast.parse(ast.unparse(node.target), mode="eval").body
        value = self._call(node, DIVIDE_IN_PLACE, place, node.value)
        return ast.copy_location(ast.Assign([node.target], value), node)

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST:
        lines: dict[str, int] = {}
        for part in node.body:
            if isinstance(part, ast.FunctionDef):
                lines[part.name] = part.lineno
            elif isinstance(part, ast.Assign):
                lines |= dict.fromkeys(map(ast.unparse, part.targets), part.lineno)
        if "__cmp__" in lines and "__eq__" not in lines:
            raise _no_effect("__cmp__", "define __eq__ and __lt__", lines)
        if "__metaclass__" in lines:
            raise _no_effect("__metaclass__", "class X(metaclass=...) has", lines)
        if "__nonzero__" in lines:
            node.body += ast.parse("__bool__ = __nonzero__").body
        return self.visit_GeneratorExp(node)

    def visit_ListComp(self, node: ast.ListComp) -> ast.AST:
        """Lets the variables keep their last values, as those of a loop."""
        leaks = self._leaks
        for loop in node.generators:
            # Python 3 can assign to no variable in what a comprehension runs over.
            self._leaks = False
            loop.iter = self.visit(loop.iter)
            self._leaks = leaks
            loop.ifs = [self.visit(test) for test in loop.ifs]
            if leaks:
                kept: list[ast.expr] = []
                for name in ast.walk(loop.target):
                    if isinstance(name, ast.Name):
                        inner = f"__{name.id}__"
                        last = ast.Name(inner, ast.Load())
                        kept.append(ast.NamedExpr(ast.Name(name.id, ast.Store()), last))
                        name.id = inner
                # A tuple, which is true, so that it filters nothing.
                loop.ifs.insert(0, ast.Tuple(kept, ast.Load()))
        node.elt = self.visit(node.elt)
        return node

    def visit_GeneratorExp(self, node: ast.AST) -> ast.AST:
        before, self._leaks = self._leaks, False
        self.generic_visit(node)
        self._leaks = before
        return node

    visit_SetComp = visit_DictComp = visit_GeneratorExp

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        body, node.body = node.body, []
        self.generic_visit(node)  # Decorators and defaults are outside of its scope.
        before, self._leaks = self._leaks, True
        node.body = [self.visit(part) for part in body]
        self._leaks = before
        return node

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        if isinstance(node.func, ast.Attribute) and (
            node.func.attr in _METHODS or node.func.attr in _LISTS
        ):
            name = ast.Constant(node.func.attr)
            node.func = self._call(node, METHOD, node.func.value, name)
        return node

    def _call(self, node: ast.AST, name: str, *arguments: ast.expr) -> ast.Call:
        function = ast.Name(name, ast.Load())
        return ast.copy_location(ast.Call(function, list(arguments), []), node)


def _no_effect(name: str, instead: str, lines: dict[str, int]) -> SyntaxError:
    return SyntaxError(
        f"a class's {name} has no effect in Python 3; {instead}",
        ("", lines[name], None, None),
    )


def old_meaning(tree: ast.Module) -> ast.Module:
    """Return a program's tree with the meaning of Python 2.

    ``/`` stays as it is where the program imports ``division`` from ``__future__``.

    Raises:
        SyntaxError: If a class contains something that Python 3 would ignore.
    """
    new_division = any(
        isinstance(node, ast.ImportFrom)
        and node.module == "__future__"
        and any(alias.name == "division" for alias in node.names)
        for node in tree.body
    )
    result: ast.Module = _OldMeaning(division=not new_division).visit(tree)
    return ast.fix_missing_locations(result)
