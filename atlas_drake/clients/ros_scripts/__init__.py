"""Programs that were written for DRCSim and ROS 1, run unmodified.

Holds stand-ins for the modules that such programs import, and the topics that they use.
A program is one more commander on the robot's command ports, and a reader of its
outputs. The command is in ``cli.script``; ``docs/scripts.md`` lists the stand-ins.
"""

from atlas_drake.clients.ros_scripts.unknown import ScriptError

__all__ = ["ScriptError"]
