"""The reference pages agree with the code."""

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


def run_snippets(page):
    """Runs a page's Python from top to bottom; returns what it has defined."""
    text = (DOCS / page).read_text("utf-8")
    names = {"__name__": page}
    for snippet in re.finditer(
        r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE
    ):
        # Empty lines before it, so that an error names the page's own line.
        above = "\n" * text[: snippet.start(1)].count("\n")
        exec(compile(above + snippet[1], page, "exec"), names)
    return names


@pytest.mark.slow
def test_a_diagram_of_your_own_does_what_its_page_says(capsys):
    names = run_snippets("in_your_diagram.md")
    first, second, third = capsys.readouterr().out.splitlines()
    height, elbow = map(float, re.findall(r"-?\d+\.\d+", first))
    assert height == pytest.approx(0.89, abs=0.02)
    assert elbow == pytest.approx(names["sine"].rest, abs=0.05)
    place = list(map(float, re.findall(r"-?\d+\.\d+", second)))
    assert place == pytest.approx([2.0, -1.0, 0.9], abs=0.03)
    assert float(re.search(r"\d\.\d+", third)[0]) < 0.02
    assert names["report"].pos_est.position.z > 0.85
    report = names["station"].GetOutputPort("atlas_sim_interface_state")
    assert report.Eval(names["context"]).pos_est.position.z > 0.85


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


@pytest.mark.parametrize(
    "path", ["README.md", *sorted(p.name for p in DOCS.glob("*.md"))]
)
def test_files_that_are_named_are_there(path):
    root = DOCS.parent
    page = root / path if path == "README.md" else DOCS / path
    for name in re.findall(r"`((?:\w+/)*\w+\.py)`(?!\])", page.read_text("utf-8")):
        places = [
            root,
            root / "atlas_drake",
            root / "benchmarks",
            root / "examples",
            DOCS,
        ]
        found = any((place / name).exists() for place in places)
        assert found or (page.parent / name).exists(), f"{path} names {name}"
