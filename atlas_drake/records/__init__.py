"""Records: what a control tick was, as one frozen value with its schema.

Data only. ``systems.tick_recorder`` makes records, ``logs`` writes and reads them;
views, figures, metrics and clients read them.
"""

from atlas_drake.records.schema import Schema
from atlas_drake.records.tick_record import TickRecord

__all__ = ["Schema", "TickRecord"]
