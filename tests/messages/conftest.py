"""How property tests run: without a time limit and the same way every time.

A busy machine must not fail a test, and a failure must come back when looked for.
"""

from hypothesis import settings

settings.register_profile("atlas_drake", deadline=None, derandomize=True)
settings.load_profile("atlas_drake")
