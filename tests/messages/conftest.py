"""Settings of the property tests: no time limit, deterministic.

A busy machine must not fail a test, and a failure must be reproducible.
"""

from hypothesis import settings

settings.register_profile("atlas_drake", deadline=None, derandomize=True)
settings.load_profile("atlas_drake")
