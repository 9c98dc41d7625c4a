"""Exit statuses of ``atlas-drake``. Nothing here ends a process."""

OK, FAILED, BAD_INPUT, OUTPUT_LOST = 0, 1, 2, 3
"""The run succeeded; the robot fell or the run failed; the input is invalid; an output
file could not be written, even if the run itself succeeded."""
INTERRUPTED = 130
"""The run was stopped by Ctrl-C."""
