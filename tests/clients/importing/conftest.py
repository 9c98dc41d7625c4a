"""Imports of Heron, as somebody might publish it, with some words replaced."""

import re
from pathlib import Path

import pytest

from atlas_drake.clients.importing.findings import Findings
from atlas_drake.clients.importing.importer import import_robot
from atlas_drake.clients.importing.options import ImportOptions

HERON = Path(__file__).parents[2] / "robots" / "heron" / "heron.urdf"


@pytest.fixture(scope="session")
def published():
    """Heron's URDF without motors, and without frames of the soles."""
    parts = r"<transmission.*?</transmission>|<frame .*?/>"
    return re.sub(parts, "", HERON.read_text(), flags=re.S)


@pytest.fixture
def source(published, tmp_path):
    """The file that is imported."""
    path = tmp_path / "published.urdf"
    path.write_text(published)
    return path


@pytest.fixture
def imported(published, source):
    """Imports Heron with some words replaced; gives robot and findings."""

    def make(*replacements, options=None):
        text = published
        for old, new in replacements:
            assert re.search(old, text, flags=re.S), old
            text = re.sub(old, new, text, flags=re.S)
        source.write_text(text)
        findings = Findings(lambda line: None)
        folder = source.parent / "made"
        robot = import_robot(source, folder, options or ImportOptions(), findings)
        return robot, findings

    return make
