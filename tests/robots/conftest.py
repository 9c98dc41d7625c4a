"""Heron: a biped that is not Atlas. No test is here."""

import shutil
from pathlib import Path

import pytest

from atlas_drake.robot import load_robot

HERON = Path(__file__).parent / "heron" / "heron.yaml"


@pytest.fixture(scope="session")
def heron():
    """The robot."""
    return load_robot(HERON)


@pytest.fixture
def copied(tmp_path):
    """Copies Heron's files with some words of its URDF replaced; gives the YAML."""

    def copy(*replacements):
        folder = tmp_path / "heron"
        shutil.copytree(HERON.parent, folder, dirs_exist_ok=True)
        urdf = folder / "heron.urdf"
        text = urdf.read_text()
        for old, new in replacements:
            assert old in text
            text = text.replace(old, new)
        urdf.write_text(text)
        return folder / "heron.yaml"

    return copy
