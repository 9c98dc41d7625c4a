"""An open humanoid control sandbox: Atlas under user and behavior control, on Drake.

This file holds no code; ``atlas_drake.messages`` holds what a script sends and reads.
"""
