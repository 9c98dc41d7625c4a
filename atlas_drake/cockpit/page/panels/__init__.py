"""The parts of the page: each builds its elements once and shows each state."""
