"""STEP: one quasi-static footstep at a time."""
