"""Defaults of the controller against the schema that editors read, and STEP's own."""

import dataclasses
import json
from pathlib import Path

from atlas_drake.config import as_plain
from atlas_drake.shipped import CONTROLLER

SCHEMA = Path(__file__).parents[2] / "docs/schema/scenario.schema.json"


def configurations(value):
    """The value and all configurations within it."""
    yield value
    for field in dataclasses.fields(value):
        part = getattr(value, field.name)
        if dataclasses.is_dataclass(part):
            yield from configurations(part)


def test_defaults_are_those_of_the_schema():
    known = json.loads(SCHEMA.read_text(encoding="utf-8"))["$defs"]
    checked = 0
    for kind in {type(value) for value in configurations(CONTROLLER)}:
        described = known[kind.__name__]["properties"]
        for field in dataclasses.fields(kind):
            if "default" in described[field.name]:
                default = as_plain(field.default)
                assert described[field.name]["default"] == default, (kind, field.name)
                checked += 1
    assert checked > 100


def test_defaults_that_the_schema_leaves_out():
    config = CONTROLLER
    limits, walk = config.step.limits, config.walk.limits
    changed = {
        name: value
        for name, value in as_plain(limits).items()
        if value != as_plain(walk)[name]
    }
    assert changed == {
        "backward": 0.36,
        "width": [0.18, 0.45],
        "rise": 0.20,
        "tilt": 0.25,
        "duration": [0.1, 20.0],
        "swing_height": [0.0, 0.60],
    }
    assert config.step.body == dataclasses.replace(config.body, yaw=0.5)
    rates = as_plain(config.manipulate.rates)
    assert rates == {
        "height": {"speed": 0.12, "acceleration": 0.4, "rate": 4.0},
        "turn": {"speed": 0.4, "acceleration": 1.2, "rate": 4.0},
        "com": {"speed": 0.08, "acceleration": 0.25, "rate": 4.0},
    }
    springs = {"orientation": (100.0, 37.0), "posture": (80.0, 18.0)}
    springs |= {"swing_position": (360.0, 40.0), "swing_orientation": (200.0, 28.0)}
    for name, (kp, kd) in (springs | {"com_height": (40.0, 12.0)}).items():
        assert as_plain(getattr(config.gains, name)) == {"kp": kp, "kd": kd}
