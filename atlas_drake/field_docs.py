"""Reads the docstrings of fields and constants, which Python does not keep.

They are strings after an assignment, which are read from the source.
"""

from __future__ import annotations

import ast
import functools
import inspect
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType


def trailing_strings(owner: type | ModuleType) -> dict[str, str]:
    """Returns the string after each assignment in a class or a module, by name.

    Raises:
        OSError: If there is no source.
    """
    body = _body(str(inspect.getsourcefile(owner)))
    if inspect.isclass(owner):
        for name in owner.__qualname__.split("."):
            body = next(
                (one.body for one in body if getattr(one, "name", None) == name),  # type: ignore[attr-defined]
                [],
            )
    found: dict[str, str] = {}
    names: list[str] = []
    for node in body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names = [node.target.id]
        elif isinstance(node, ast.Assign):
            names = [t.id for t in node.targets if isinstance(t, ast.Name)]
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            found |= dict.fromkeys(names, inspect.cleandoc(str(node.value.value)))
            names = []
        else:
            names = []
    return found


@functools.lru_cache(maxsize=64)
def _body(path: str) -> Sequence[ast.stmt]:
    """Parses a file once for all its classes."""
    return ast.parse(Path(path).read_text()).body
