"""The tutorial's notebook runs from top to bottom, and contains its outputs."""

from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat")

NOTEBOOK = Path(__file__).parents[1] / "examples" / "tutorial.ipynb"
LIMIT = 300
"""On one cell [s]."""


def printed(notebook):
    return "".join(
        output["text"]
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        if output["output_type"] == "stream" and output["name"] == "stdout"
    )


def figures(notebook):
    outputs = [out for cell in notebook.cells for out in cell.get("outputs", [])]
    return [out for out in outputs if "image/png" in out.get("data", {})]


def test_the_notebook_shows_its_figures_and_no_error():
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(notebook)
    assert len(figures(notebook)) == 4
    assert "Atlas stands." in printed(notebook)
    assert "Error" not in NOTEBOOK.read_text(encoding="utf-8")
    assert NOTEBOOK.stat().st_size < 200_000


@pytest.mark.slow
def test_the_notebook_runs_to_a_good_end():
    nbclient = pytest.importorskip("nbclient")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = []
    # A cell that raises an error raises it here.
    nbclient.NotebookClient(notebook, timeout=LIMIT, kernel_name="python3").execute()
    out = printed(notebook)
    assert "Atlas stands." in out
    assert out.count("mm from where it was sent") == 4
    assert len(figures(notebook)) == 4
