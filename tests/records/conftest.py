"""What the tests of records share: writing records to a log, and reading them."""

import pytest

from atlas_drake import read_log
from atlas_drake.logs.header import Header
from atlas_drake.logs.mcap_writer import McapWriter


@pytest.fixture(scope="session")
def through_a_log(tmp_path_factory):
    """Writes records to a log, and reads it."""
    path = tmp_path_factory.mktemp("records") / "records.mcap"

    def through(schema, records):
        writer = McapWriter(path, Header("atlas", 0.01, ""))
        writer.begin(schema)
        for record in records:
            writer.record(record)
        writer.close()
        return read_log(path)

    return through
