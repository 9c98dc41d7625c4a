"""Parameters of STAND.

Values only; ``stand`` uses them.
"""

from dataclasses import dataclass

from atlas_drake.config import Configuration, NotNegative


@dataclass(frozen=True)
class StandConfig(Configuration):
    """Parameters of STAND and STAND_PREP."""

    com_speed: NotNegative = 0.08
    """Speed of the CoM reference towards the middle of the feet [m/s]."""
    foot_slip: NotNegative = 0.01
    """Re-latch the pose of a sole that slipped farther than this [m]."""
    recovery_steps: bool = True
    """Whether STAND and MANIPULATE hand over to WALK for a step when the DCM leaves the
    support polygon. The step is made to the height of the ground below the feet."""
    recovery_margin: NotNegative = 0.01
    """Distance of the DCM outside the support polygon from which a step is needed
    [m]."""
    recovery_load: NotNegative = 0.3
    """Least load on both feet for a step, in weights of the robot: a robot that hangs
    does not step [-]."""
