"""WALK: its phases, its plan, and its steps."""
