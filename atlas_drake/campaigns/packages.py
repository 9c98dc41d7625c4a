"""Checks that the packages for tables, statistics and pictures are installed."""

from importlib.util import find_spec

from atlas_drake.campaigns.errors import CampaignError

PACKAGES = ("matplotlib", "pyarrow", "scipy")
"""Packages of the extra ``sweep``."""


def check_packages() -> None:
    """Checks that every package of the extra is installed, without loading any.

    Raises:
        CampaignError: Naming the packages that are missing.
    """
    missing = ", ".join(name for name in PACKAGES if find_spec(name) is None)
    if missing:
        problem = f'{missing} not installed: pip install "atlas-drake[sweep]"'
        raise CampaignError("packages", missing, problem)
