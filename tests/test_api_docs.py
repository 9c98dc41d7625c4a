"""Every public function and class has a docstring and a page."""

import inspect
import os
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import pytest

import atlas_drake
from atlas_drake.diagrams import atlas_station, control_mode_switch
from atlas_drake.visualization import overlays

ROOT = Path(__file__).parents[1]
PUBLIC = {name: getattr(atlas_drake, name) for name in atlas_drake.__all__}
for module in (atlas_station, control_mode_switch, overlays):
    PUBLIC |= {
        name: value
        for name, value in vars(module).items()
        if not name.startswith("_")
        and getattr(value, "__module__", "") == module.__name__
    }


def functions():
    """Public functions, and methods of public classes, by name."""
    for name, value in PUBLIC.items():
        if inspect.isfunction(value):
            yield pytest.param(value, id=name)
        elif inspect.isclass(value) and value.__module__.startswith("atlas_drake"):
            for member, what in inspect.getmembers(value, callable):
                own = getattr(what, "__module__", None) or ""
                if not member.startswith("_") and own.startswith("atlas_drake"):
                    yield pytest.param(what, id=f"{name}.{member}")


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_name_is_explained(name):
    value = PUBLIC[name]
    if inspect.isclass(value) or inspect.isroutine(value):
        # That of a dataclass without a docstring is its signature.
        assert value.__doc__
        assert not value.__doc__.startswith(f"{name}(")


@pytest.mark.parametrize("function", list(functions()))
def test_every_public_function_explains_its_arguments(function):
    text = inspect.getdoc(function) or ""
    assert text
    arguments = [
        name
        for name in inspect.signature(function).parameters
        if name not in ("self", "cls")
    ]
    explained = text.partition("Args:\n")[2]
    missing = [name for name in arguments if not re.search(rf"[ *]{name}:", explained)]
    assert not missing


@pytest.mark.slow
def test_every_module_gets_a_page_without_a_warning(tmp_path):
    pytest.importorskip("pdoc")
    command = [sys.executable, "-W", "error", ROOT / "docs" / "make_api.py"]
    done = subprocess.run(
        [*command, "--output", tmp_path],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert done.returncode == 0, done.stderr
    assert "Warn" not in done.stderr
    modules = pkgutil.walk_packages(atlas_drake.__path__, "atlas_drake.")
    for name in (module.name for module in modules):
        if not name.endswith("__"):
            assert (tmp_path / name.replace(".", "/")).with_suffix(".html").is_file()
    front = (tmp_path / "atlas_drake.html").read_text(encoding="utf-8")
    for name in PUBLIC.keys() & set(atlas_drake.__all__):
        assert f'id="{name}"' in front
    assert 'id="AtlasSimulation.publish"' in front
