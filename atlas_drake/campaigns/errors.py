"""Errors of campaigns, and the check for the packages of the extra ``sweep``."""

from importlib.util import find_spec

from atlas_drake.errors import ScenarioError

PACKAGES = ("matplotlib", "pyarrow", "scipy")
"""Packages of the extra ``sweep``: pictures, tables and statistics."""


class CampaignError(ScenarioError):
    """A campaign that cannot be run, or results that cannot be used.

    It has the attributes ``field``, ``value`` and ``problem`` of a ScenarioError.
    """


def check_packages() -> None:
    """Checks that every package of the extra is installed, without loading any.

    Raises:
        CampaignError: Naming the packages that are missing.
    """
    missing = ", ".join(name for name in PACKAGES if find_spec(name) is None)
    if missing:
        problem = f'{missing} not installed: pip install "atlas-drake[sweep]"'
        raise CampaignError("packages", missing, problem)
