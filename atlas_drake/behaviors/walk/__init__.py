"""WALK: its phases, its plan, and the steps it takes next."""
