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
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.diagrams.atlas_station import (
    make_atlas_station,
    make_whole_body_controller,
)
from atlas_drake.diagrams.control_mode_switch import make_control_mode_switch

ROOT = Path(__file__).parents[1]
PUBLIC = {name: getattr(atlas_drake, name) for name in atlas_drake.__all__}
for value in (
    make_atlas_station,
    make_whole_body_controller,
    make_control_mode_switch,
    Overlays,
):
    PUBLIC[value.__name__] = value


def functions():
    """Public functions, and methods of public classes, by name."""
    for name, value in PUBLIC.items():
        if inspect.isfunction(value):
            yield name, value
        elif inspect.isclass(value) and value.__module__.startswith("atlas_drake"):
            for member, what in inspect.getmembers(value, callable):
                own = getattr(what, "__module__", None) or ""
                if not member.startswith("_") and own.startswith("atlas_drake"):
                    yield f"{name}.{member}", what


def test_every_public_name_is_explained():
    for name, value in PUBLIC.items():
        if inspect.isclass(value) or inspect.isroutine(value):
            # That of a dataclass without a docstring is its signature.
            assert value.__doc__, name
            assert not value.__doc__.startswith(f"{name}("), name


def test_every_public_function_explains_its_arguments():
    missing = []
    for name, function in functions():
        text = inspect.getdoc(function) or ""
        assert text, name
        explained = text.partition("Args:\n")[2]
        for argument in {*inspect.signature(function).parameters} - {"self", "cls"}:
            if not re.search(rf"[ *]{argument}:", explained):
                missing.append((name, argument))
    assert missing == []


@pytest.mark.slow
def test_the_site_has_every_page_and_no_broken_link(tmp_path):
    """MkDocs ends with an error for a warning, such as a link that leads nowhere."""
    pytest.importorskip("mkdocstrings")
    command = [sys.executable, "-m", "mkdocs", "build", "--quiet"]
    done = subprocess.run(
        [*command, "--site-dir", tmp_path],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "WHOLE_SITE": "false"},
    )
    assert done.returncode == 0, done.stderr
    modules = pkgutil.walk_packages(atlas_drake.__path__, "atlas_drake.")
    for name in (module.name for module in modules):
        if not name.endswith("__"):
            assert (tmp_path / f"api/{name}.html").is_file()
    front = (tmp_path / "api/index.html").read_text(encoding="utf-8")
    for name in atlas_drake.__all__:
        value = getattr(atlas_drake, name)
        if getattr(value, "__module__", "").startswith("atlas_drake"):
            page, anchor = f"{value.__module__}.html", f"{value.__module__}.{name}"
            assert f'href="{page}#{anchor}"' in front
            text = (tmp_path / "api" / page).read_text(encoding="utf-8")
            assert f'id="{anchor}"' in text
    start = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert 'href="docs/control.html"' in start
    assert (tmp_path / "docs/images/loop.svg").is_file()
    # The site works without a network.
    assert not re.search(r'<(?:script|link|img)[^>]+(?:src|href)="https?:', start)
