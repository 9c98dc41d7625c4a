"""Exit statuses of ``atlas-drake``. Nothing here ends a process."""

OK, FAILED, BAD_INPUT, OUTPUT_LOST = 0, 1, 2, 3
"""Did what was asked; fell or failed; input that cannot be used; an output file that
could not be written, however Atlas ended."""
INTERRUPTED = 130
"""Stopped by Ctrl-C, whatever was written."""
