"""Campaigns: many runs of one scenario with random values, and their statistics.

A single run is in ``simulation``; the fields of a scenario are in ``scenario``.
"""

from atlas_drake.clients.campaigns.campaign import Campaign, Threshold
from atlas_drake.clients.campaigns.reading import load_campaign
from atlas_drake.clients.campaigns.runner import run_campaign

__all__ = [
    "Campaign",
    "Threshold",
    "load_campaign",
    "run_campaign",
]
