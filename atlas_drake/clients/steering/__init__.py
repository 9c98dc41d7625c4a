"""Steering by hand and by script: a pilot, a stream of steps, motions of joints."""
