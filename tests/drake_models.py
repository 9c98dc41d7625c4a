"""Which robots a test can have: those whose files are at hand. No test is here."""

import os
from pathlib import Path

import pytest

from atlas_drake.robot import LOCAL_MODELS, available_robots, models_at_hand

_COPY = Path(__file__).parents[2] / "shared" / "reference" / "drake_models"
if _COPY.is_dir():
    os.environ.setdefault(LOCAL_MODELS, str(_COPY))

needs_drake_models = pytest.mark.skipif(
    not models_at_hand(),
    reason=f"Drake's models are neither in its cache nor named by {LOCAL_MODELS}",
)
EVERY_ROBOT = [
    pytest.param(name, marks=needs_drake_models if name == "drake_atlas" else ())
    for name in available_robots()
]
