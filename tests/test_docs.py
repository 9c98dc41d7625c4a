"""The reference pages say what the code says."""

import importlib.util
import re
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"


@pytest.fixture(scope="module")
def pages():
    """What the generator would write now."""
    sys.path.insert(0, str(DOCS))
    try:
        spec = importlib.util.spec_from_file_location(
            "make_reference", DOCS / "make_reference.py"
        )
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(DOCS))
    return module.all_pages()


def test_the_reference_pages_are_of_today(pages):
    folder = DOCS / "reference"
    found = {
        str(path.relative_to(folder)): path.read_text(encoding="utf-8")
        for path in folder.rglob("*.md")
    }
    assert found == pages, "run: python docs/make_reference.py"


def test_every_field_of_the_interfaces_messages_is_explained(pages):
    empty = [
        (page, line)
        for page, text in pages.items()
        if page.startswith(("Atlas", "Imu", "flags", "behaviors/"))
        for line in text.splitlines()
        if line.startswith("| `") and line.endswith("|  |")
    ]
    assert not empty


@pytest.mark.parametrize(
    "path",
    ["README.md", *sorted(str(p.relative_to(DOCS.parent)) for p in DOCS.rglob("*.md"))],
)
def test_links_lead_somewhere(path):
    page = DOCS.parent / path
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text("utf-8")):
        if not target.startswith(("http:", "https:")):
            assert (page.parent / target).exists(), target
