"""STEP: one footstep at a time, statically."""
