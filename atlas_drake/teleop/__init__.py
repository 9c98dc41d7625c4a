"""Steering the robot by hand: a control panel in the browser and what it commands.

One more commander beside a programme; no control law and no physics.
"""
