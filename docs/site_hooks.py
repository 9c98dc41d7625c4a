"""Puts the pages of the repository and of all docstrings into the site.

MkDocs calls these functions. Pages keep their places in the repository, so that their
links are right on GitHub and here. A link to a module leads to its docstrings and code,
a link to another file or folder to a page that shows it.
"""

from __future__ import annotations

import functools
import pkgutil
import posixpath
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

import atlas_drake

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "docs"))
import make_reference  # noqa: E402

PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "models/README.md")
ASSETS = {".gif", ".ipynb", ".mp4", ".png", ".svg"}
"""Endings of linked files that the site holds as they are."""
LANGUAGES = {".py": "python", ".yaml": "yaml"}
IN_PACKAGE = re.compile(r"^atlas_drake/(?=diagrams\b|models\b)")
"""What precedes the top-level folders that the package holds as links."""
LINK = re.compile(r"(\]\()([^)#\s]+)((?:#[^)\s]*)?\))")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Replaces the files that MkDocs found in docs/ by all pages and their links."""
    for file in list(files):
        if Path(file.abs_src_path or "").is_relative_to(config.docs_dir):
            files.remove(file)

    def add(uri: str, **content: str) -> None:
        files.append(File.generated(config, uri, **content))

    pages = [*PAGES]
    pages += (
        path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").rglob("*.md")
    )
    texts = {page: (ROOT / page).read_text("utf-8") for page in pages}
    for name, text in make_reference.all_pages().items():
        texts[f"docs/reference/{name}"] = text
    for page, text in texts.items():
        add(page, content=text)
    modules = dict(_modules())
    add("api/index.md", content=_index_of(modules))
    for name in modules.values():
        add(f"api/{name}.md", content=f"::: {name}\n")
    linked = {target for page, text in texts.items() for target in _targets(page, text)}
    for target in sorted(linked - {*texts} - {*modules}):
        path = ROOT / target
        if path.suffix in ASSETS:
            add(target, abs_src_path=str(path))
        elif path.exists():
            add(f"source/{target}.md", content=_page_showing(path))
    return files


def on_page_markdown(
    markdown: str, page: Page, config: MkDocsConfig, files: Files
) -> str:
    """Turns links to files of the repository into links to their pages here."""
    here = page.file.src_uri
    modules = _modules()

    def replace(found: re.Match[str]) -> str:
        target = _target(here, found[2])
        if target is None or files.get_file_from_path(target):
            return found[0]
        module = modules.get(target)
        place = f"source/{target}.md" if module is None else f"api/{module}.md"
        return found[1] + posixpath.relpath(place, posixpath.dirname(here)) + found[3]

    return LINK.sub(replace, markdown)


@functools.cache
def _modules() -> dict[str, str]:
    """Returns the name of each module, by its path in the repository."""
    modules = {"atlas_drake": "atlas_drake"}
    for found in pkgutil.walk_packages(atlas_drake.__path__, "atlas_drake."):
        path = IN_PACKAGE.sub("", found.name.replace(".", "/"))
        if not found.name.endswith("__main__"):
            modules[path if found.ispkg else f"{path}.py"] = found.name
    return modules


def _targets(page: str, text: str) -> Iterator[str]:
    """Returns the paths in the repository that a page links to."""
    for found in LINK.finditer(text):
        target = _target(page, found[2])
        if target is not None:
            yield target


def _target(page: str, link: str) -> str | None:
    """Returns the path in the repository that a link leads to; None for a URL."""
    if ":" in link:
        return None
    path = posixpath.normpath(posixpath.join(posixpath.dirname(page), link))
    return IN_PACKAGE.sub("", path)


def _page_showing(path: Path) -> str:
    """Returns a page with the content of a file or folder."""
    title = f"# {path.relative_to(ROOT)}\n\n"
    if path.is_dir():
        names = sorted(item.name for item in path.iterdir() if item.name[0] not in "._")
        return title + "".join(f"- `{name}`\n" for name in names)
    text = path.read_text("utf-8")
    return f"{title}`````{LANGUAGES.get(path.suffix, 'text')}\n{text}\n`````\n"


def _index_of(modules: dict[str, str]) -> str:
    """Returns the index of all modules, with the names that ``atlas_drake`` offers."""
    lines = ["# Python", "", "## Names to import from atlas_drake", ""]
    for name in sorted(atlas_drake.__all__):
        module = getattr(getattr(atlas_drake, name), "__module__", "")
        if module.startswith("atlas_drake"):
            lines.append(f"- [`{name}`]({module}.md#{module}.{name})")
    lines += ["", "## Modules", ""]
    lines += [f"- [`{name}`]({name}.md)" for name in sorted(modules.values())]
    return "\n".join(lines) + "\n"
