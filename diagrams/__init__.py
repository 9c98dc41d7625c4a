"""Wiring only: functions that return a built Drake Diagram."""
