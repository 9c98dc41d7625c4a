"""STAND and STAND_PREP, and the stance guard of all standing behaviors."""
