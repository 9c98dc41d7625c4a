"""Gains of the harness in which a robot can start. Values only."""

from dataclasses import dataclass

from atlas_drake.configuration import Configuration, NotNegative, Positive


@dataclass(frozen=True)
class HarnessGains(Configuration):
    """Gains that hold the robot; the defaults are stable at every physics step."""

    natural_frequency: Positive = 12.0
    """Natural frequency of the robot's mass on the harness [rad/s]."""
    damping_ratio: NotNegative = 1.0
    """Damping ratio of the robot's mass on the harness [-]."""
    rotational_stiffness: NotNegative = 4000.0
    """Rotational stiffness at the pelvis [N·m/rad]."""
    rotational_damping: NotNegative = 300.0
    """Rotational damping at the pelvis [N·m·s/rad]."""
    lowering_speed: Positive = 0.10
    """Speed at which a released robot is lowered [m/s]."""
    fading_time: Positive = 1.0
    """Time in which the harness transfers its load to the legs after lowering [s]."""
