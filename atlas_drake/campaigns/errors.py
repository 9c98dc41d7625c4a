"""What can be wrong with a campaign."""

from atlas_drake.errors import ScenarioError


class CampaignError(ScenarioError):
    """A campaign that cannot be run, or results that cannot be used.

    It has the attributes ``field``, ``value`` and ``problem`` of a ScenarioError.
    """
