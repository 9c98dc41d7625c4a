"""How the robot stands, in every behavior that balances it. Values only."""

from dataclasses import dataclass

from atlas_drake.configuration import Configuration, NotNegative, Positive
from atlas_drake.planning.footholds import STANCE_WIDTH


@dataclass(frozen=True)
class StanceConfig(Configuration):
    """How the robot stands."""

    width: Positive = STANCE_WIDTH
    """Distance between the soles' middles of feet side by side [m]."""
    com_drop: NotNegative = 0.02
    """Lowering of the center of mass in standing and walking below the stand-prep pose
    [m]: bent knees give the trailing leg its reach."""
    balance_effort: NotNegative = 15.0
    """Effort that a behavior must be able to apply at hip pitch and ankle pitch of a
    leg to balance with the leg [N·m]."""
