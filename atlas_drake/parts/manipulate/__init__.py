"""MANIPULATE: the pelvis moves while the feet stay."""
