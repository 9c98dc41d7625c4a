"""Writes the URDF files of the robots, and the meshes they show, into ``models``.

Run it after changing a table in ``robot_models``. It reads nothing but those tables.
"""

from __future__ import annotations

from pathlib import Path

from robot_models.appearance import meshes, visuals
from robot_models.collisions import (
    FILTER_GROUPS,
    IGNORED_PAIRS,
    collisions,
    friction,
)
from robot_models.inertias import HEAVY, LIGHT
from robot_models.skeleton import FRAMES, JOINTS, LINKS
from robot_models.urdf import Robot, to_urdf

INERTIAS = {"atlas": LIGHT, "atlas_v3": HEAVY}


def build() -> dict[str, str]:
    """Returns the text of every generated file by its path below ``models``."""
    urdfs = {f"{name}.urdf": to_urdf(describe(name)) for name in INERTIAS}
    return urdfs | meshes()


def describe(name: str) -> Robot:
    """Returns the description of one robot, `"atlas"` or `"atlas_v3"`."""
    return Robot(
        name=name,
        inertials={link: INERTIAS[name][link] for link in LINKS},
        joints=JOINTS,
        frames=FRAMES,
        collisions=collisions(name),
        friction={link: friction(link) for link in LINKS},
        filter_groups=FILTER_GROUPS,
        ignored_pairs=IGNORED_PAIRS,
        visuals=visuals(name),
    )


def main() -> None:
    """Writes every generated file."""
    folder = Path(__file__).parents[1] / "models"
    for path, text in build().items():
        target = folder / path
        target.parent.mkdir(exist_ok=True)
        target.write_text(text, encoding="utf-8", newline="\n")
        print(f"wrote {path}")


if __name__ == "__main__":
    main()
