"""Numbers of a record by name, found where the cockpit's page finds them."""

import orjson

from atlas_drake.clients.cockpit.describe import columns_of
from atlas_drake.clients.cockpit.frame import frame_json


def numbers_on_page(sim, record):
    """Every number of a record by name; NaN for what it does not have."""
    page = orjson.loads(frame_json(record, sim.behaviors, None))["record"]
    columns = columns_of(sim.schema, record)
    return {name: _at(page, column["path"]) for name, column in columns.items()}


def _at(value, path):
    for key in path:
        if value is None or (isinstance(value, list) and key >= len(value)):
            return float("nan")
        value = value[key]
    return float("nan") if value is None else float(value)
