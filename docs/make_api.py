"""Writes the pages of all public functions and classes into build/docs, by pdoc.

    python docs/make_api.py [--output FOLDER]

HTML with a search, from the docstrings; ``make docs`` runs it. The pages of messages
and behaviors, which GitHub shows as they are, come from ``make_reference.py``.
"""

# ruff: noqa: T201

from __future__ import annotations

import argparse
import pkgutil
import sys
import warnings
from pathlib import Path

import pdoc
import pdoc.render

import atlas_drake

API = Path(__file__).parents[1] / "build" / "docs"


def public_modules() -> list[str]:
    """The package, and what pdoc does not find in it by itself.

    It goes into packages, but not where ``__all__`` names what is public.
    """
    modules = ["atlas_drake"]
    for found in pkgutil.walk_packages(atlas_drake.__path__, "atlas_drake."):
        parent = sys.modules[found.name.rpartition(".")[0]]
        if hasattr(parent, "__all__") and not found.name.endswith("__"):
            modules.append(found.name)
    return modules


def write_api(output: Path) -> None:
    """Renders all pages.

    Args:
        output: Folder for them; it is made, and begins at ``index.html``.
    """
    # pdoc looks into the module's dictionary, and what needs Drake is imported late.
    for name in atlas_drake.__all__:
        setattr(atlas_drake, name, getattr(atlas_drake, name))
    # Fields of a NamedTuple are known by their names, not by those of their modules.
    warnings.filterwarnings("ignore", "Error parsing type annotation ForwardRef")
    pdoc.render.configure(docformat="google", show_source=False)
    pdoc.pdoc(*public_modules(), output_directory=output)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, default=API, metavar="FOLDER")
    folder = parser.parse_args().output
    write_api(folder)
    print(f"Open {folder / 'index.html'}")
