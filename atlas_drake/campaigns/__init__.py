"""Campaigns: many runs of one scenario with random values, and their statistics.

A single run is in ``simulation``; the fields of a scenario are in ``scenario``.
"""

from atlas_drake.campaigns.campaign import Campaign, Threshold
from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.campaigns.reading import campaign_from, load_campaign
from atlas_drake.campaigns.runner import Shard, run_campaign

__all__ = [
    "Campaign",
    "CampaignError",
    "Shard",
    "Threshold",
    "campaign_from",
    "load_campaign",
    "run_campaign",
]
