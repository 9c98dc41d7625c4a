"""Laws of single joints: the user's PID, its blend with the behavior, damping."""
