"""The page's colors are those of figures and 3D view."""

import re
from importlib.resources import files

from matplotlib.colors import to_hex

from atlas_drake import palette

NAMED = re.compile(r'(\w+) = (\[[^]]*\]|"[^"]*")')
COLOR = re.compile(r"#[0-9a-f]{6}")


def test_the_page_has_the_palette_of_the_3d_view():
    script = files("atlas_drake.clients.cockpit.page") / "static" / "palette.js"
    found = dict(NAMED.findall(script.read_text()))
    assert set(found) >= {"COM", "DCM", "COP", "FEET", "BEHAVIOR", "USER"}
    for name, text in found.items():
        color = getattr(palette, name)
        expected = color if name == "FEET" else [color]
        assert COLOR.findall(text) == [to_hex(one) for one in expected], name
