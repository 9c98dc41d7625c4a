"""Teleoperation: a control panel in the browser that sends commands.

The panel is one more commander beside a programme. Control laws and physics are
elsewhere.
"""
