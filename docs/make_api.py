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
    """Lists the package and the modules that pdoc does not find by itself.

    pdoc descends into packages, but not into those that define ``__all__``.
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
    # pdoc reads the module's dictionary, but names that need Drake are imported lazily.
    for name in atlas_drake.__all__:
        setattr(atlas_drake, name, getattr(atlas_drake, name))
    # pdoc resolves fields of a NamedTuple without the names of their modules.
    warnings.filterwarnings("ignore", "Error parsing type annotation ForwardRef")
    pdoc.render.configure(docformat="google", show_source=False)
    pdoc.pdoc(*public_modules(), output_directory=output)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, default=API, metavar="FOLDER")
    folder = parser.parse_args().output
    write_api(folder)
    print(f"Open {folder / 'index.html'}")
