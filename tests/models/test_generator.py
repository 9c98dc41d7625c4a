"""The generator of the models: its files are up to date and its parts are right."""

from __future__ import annotations

from pathlib import Path

import pytest
from build_models import build
from robot_models.appearance_limbs import LEG
from robot_models.collisions import FILTER_GROUPS
from robot_models.skeleton import LINKS, SOLE_CENTER
from robot_models.triangles import merge

MODELS = Path(__file__).parents[2] / "models"
LARGEST_MESH = 250_000
"""Size that no mesh file may exceed [bytes]."""


def test_files_are_what_the_generator_writes_and_no_mesh_is_left_over():
    files = build()
    for path, text in files.items():
        written = (MODELS / path).read_text(encoding="utf-8")
        assert written == text, f"{path} is out of date: run tools/build_models.py"
        assert len(text) < LARGEST_MESH
    present = {f"meshes/{path.name}" for path in (MODELS / "meshes").iterdir()}
    assert present == {path for path in files if path.startswith("meshes/")}


def test_every_link_is_in_one_filter_group():
    grouped = [link for links in FILTER_GROUPS.values() for link in links]
    assert sorted(grouped) == sorted(LINKS)


def test_drawn_sole_ends_where_the_foot_touches_the_ground():
    parts = [s.triangles() for surfaces in LEG["foot"].values() for s in surfaces]
    lowest = merge(*parts).vertices[:, 2].min()
    assert lowest == pytest.approx(SOLE_CENTER[2], abs=1e-9)
