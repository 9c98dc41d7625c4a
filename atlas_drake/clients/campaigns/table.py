"""The table of a campaign's trials, and the statistics of it.

Needs the packages of the extra ``sweep``, which load only when they are used.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from atlas_drake.clients.campaigns.plan import Records
from atlas_drake.errors import ScenarioError

if TYPE_CHECKING:
    import pandas as pd

PACKAGES = ("matplotlib", "pandas", "pyarrow", "scipy")
"""Packages of the extra ``sweep``."""
VALUES, FIGURES = "values.", "figures."
"""Prefixes of the table's columns of values that vary, and of figures."""
LEVEL = 0.95
"""Confidence level of every interval [-]."""


def check_packages() -> None:
    """Checks that every package of the extra is installed, without loading any."""
    missing = ", ".join(name for name in PACKAGES if find_spec(name) is None)
    if missing:
        problem = f'{missing} not installed: pip install "atlas-drake[sweep]"'
        raise ScenarioError("packages", missing, problem)


def table_of(records: Records) -> pd.DataFrame:
    """Returns the table of the trials, in the order of their numbers.

    Columns are those of a record, such as ``seed``, ``values.PATH``, ``figures.NAME``.
    """
    import pandas as pd

    frame = pd.json_normalize([records[n] for n in sorted(records)], max_level=1)
    if records:  # Tables of several campaigns fit together if seeds are of one type.
        frame = frame.astype({"seed": "uint64"})
    return frame.convert_dtypes()


def numeric_figures(frame: pd.DataFrame) -> list[str]:
    """Returns the columns of the figures that are numbers in every trial, or None."""
    numbers = frame.select_dtypes("number")
    return [name for name in numbers if name.startswith(FIGURES)]


def label(value: object) -> str:
    """Returns a short text of a value, which may be a list or a mapping."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def case_label(case: Mapping[str, Any]) -> str:
    """Returns the text of a case."""
    return ", ".join(f"{path} = {label(v)}" for path, v in case.items()) or "all"


def share_interval(successes: int, trials: int) -> tuple[float, float]:
    """Returns Wilson's score interval of a probability, from 1 trial or more."""
    # Scipy takes a second to load.
    from scipy.stats import binomtest

    interval = binomtest(successes, trials).proportion_ci(LEVEL, method="wilson")
    return float(interval.low), float(interval.high)


def mcnemar(only_first: int, only_second: int) -> float:
    """Returns McNemar's exact two-sided p-value that two success rates are equal.

    The arguments are the numbers of pairs of which only one succeeded.
    """
    from scipy.stats import binomtest

    discordant = only_first + only_second
    return float(binomtest(only_first, discordant).pvalue) if discordant else 1.0


def mean_interval(values: Sequence[float]) -> tuple[float, float] | None:
    """Returns Student's t interval of a mean; None for fewer than two values."""
    from scipy.stats import sem, t

    if len(values) < 2:
        return None
    mean = sum(values) / len(values)
    half = t.ppf(0.5 + 0.5 * LEVEL, len(values) - 1) * sem(values)
    return float(mean - half), float(mean + half)
