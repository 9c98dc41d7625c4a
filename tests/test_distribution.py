"""The distributions are complete: what is built from the sources runs the tutorial."""

import os
import site
import subprocess
import sys
import tarfile
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LINKED = ("diagrams", "models")
"""Folders that are links within the package."""


def run(*command, **options):
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, **options
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def files_in(folder):
    """Names of a folder's files, relative to the root."""
    return {
        str(path.relative_to(ROOT))
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


@pytest.mark.slow
def test_a_wheel_from_the_source_distribution_runs_the_tutorial(tmp_path):
    """``build`` makes the wheel of the source distribution, not of the checkout."""
    dist, fresh = tmp_path / "dist", tmp_path / "fresh"
    run(sys.executable, "-m", "build", "--outdir", str(dist), str(ROOT))
    (source,), (wheel,) = dist.glob("*.tar.gz"), dist.glob("*.whl")
    with tarfile.open(source) as archive:
        packed = {name.partition("/")[2] for name in archive.getnames()}
    for folder in LINKED:
        expected = files_in(folder)
        assert expected <= packed
        assert {f"atlas_drake/{name}" for name in expected} <= packed

    venv.create(fresh)
    python = str(fresh / "bin" / "python")
    # Drake and numpy are those of this environment; this package is not.
    (packages,) = fresh.glob("lib/python*/site-packages")
    (packages / "dependencies.pth").write_text("\n".join(site.getsitepackages()))
    pip = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet"]
    run(*pip, "--no-deps", "--ignore-installed", str(wheel))
    clean = {"cwd": tmp_path, "env": {"PATH": os.environ["PATH"]}}
    place = "import atlas_drake; print(atlas_drake.__file__)"
    assert run(python, "-c", place, **clean).startswith(str(packages))
    out = run(str(fresh / "bin" / "atlas-drake"), "demo", "--headless", **clean)
    assert "Success: the robot is upright after 17.0 s" in out
