"""What the inertial measurement unit in the pelvis reports.

How it is simulated, noise included, is not in this file.
"""

from dataclasses import dataclass, field

from atlas_drake.messages.base import Message
from atlas_drake.messages.geometry import Header, Quaternion, Vector3


@dataclass(slots=True, eq=False)
class Imu(Message):
    """One measurement.

    Attributes:
        header: Time of the measurement.
        orientation: Orientation of the unit in the world frame.
        angular_velocity: Angular velocity in the unit's frame [rad/s].
        linear_acceleration: Specific force in the unit's frame [m/s²]: standing
            still, it points up and measures gravity.
    """

    header: Header = field(default_factory=Header)
    orientation: Quaternion = field(default_factory=Quaternion)
    angular_velocity: Vector3 = field(default_factory=Vector3)
    linear_acceleration: Vector3 = field(default_factory=Vector3)
