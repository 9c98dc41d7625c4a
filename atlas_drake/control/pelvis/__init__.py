"""Poses of the pelvis that the legs can reach, and motion between them."""
