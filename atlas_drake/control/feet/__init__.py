"""Feet and legs: footsteps, swing, toe-off, reach."""
