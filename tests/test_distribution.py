"""The distributions are complete: a wheel from the sources has all modules and runs."""

import compileall
import json
import os
import shutil
import site
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest

from atlas_drake.clients.cockpit.fields import scenario_fields
from atlas_drake.config import as_plain
from atlas_drake.scenario import Scenario

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
def test_a_wheel_from_the_source_distribution_begins_the_tutorial(tmp_path):
    """``build`` makes the wheel of the source distribution, not of the checkout."""
    dist, fresh = tmp_path / "dist", tmp_path / "fresh"
    run(sys.executable, "-m", "build", "--outdir", str(dist), str(ROOT))
    (source,), (wheel,) = dist.glob("*.tar.gz"), dist.glob("*.whl")
    with tarfile.open(source) as archive:
        packed = {name.partition("/")[2] for name in archive.getnames()}
    linked = set().union(*map(files_in, LINKED))
    assert linked <= packed
    modules = {*files_in("atlas_drake"), *(f"atlas_drake/{f}" for f in linked)}
    assert modules <= set(zipfile.ZipFile(wheel).namelist())

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
    demo = [str(fresh / "bin" / "atlas-drake"), "demo", "--headless"]
    out = run(*demo, "--set", "duration=0.1", **clean)
    assert "Success: the robot is upright after 0.1 s" in out


WITHOUT_SOURCES = """
import json
from atlas_drake import config
from atlas_drake.clients.cockpit.fields import settings_of
from atlas_drake.config import as_plain
from atlas_drake.scenario import Scenario

assert config.__file__.endswith(".pyc")
scenario = Scenario(model="{robot}").resolved()
fields = settings_of(scenario, "")["fields"]
units = {{one["path"]: one["unit"] for one in fields}}
print(json.dumps([as_plain(scenario.controller), units]))
"""


@pytest.mark.slow
def test_compiled_files_alone_scale_every_value_and_fill_the_cockpit(tmp_path):
    """Frozen programs have no sources, in which texts of fields stand."""
    package = tmp_path / "atlas_drake"
    shutil.copytree(ROOT / "atlas_drake", package)
    compileall.compile_dir(package, quiet=2, legacy=True)
    for source in package.rglob("*.py"):
        source.unlink()
    robot = ROOT / "tests/robots/heron/heron.yaml"
    program = WITHOUT_SOURCES.format(robot=robot)
    out = run(sys.executable, "-c", program, cwd=tmp_path)
    scenario = Scenario(model=str(robot)).resolved()
    units = {one["path"]: one["unit"] for one in scenario_fields(scenario)}
    assert json.loads(out) == [as_plain(scenario.controller), units]
