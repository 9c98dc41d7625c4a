"""The report of the inertial measurement unit (IMU) in the pelvis.

Its simulation is in ``systems``, its noise in ``scenario.noise``.
"""

from dataclasses import dataclass, field

from atlas_drake.messages.base import Message
from atlas_drake.messages.geometry import Header, Quaternion, Vector3


@dataclass(slots=True, eq=False)
class Imu(Message):
    """One measurement of the IMU.

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
