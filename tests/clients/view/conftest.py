"""A short run, and records for views: that of the run with some fields changed."""

import dataclasses

import pytest

from atlas_drake import AtlasSimulation
from atlas_drake.frozen import replace
from atlas_drake.systems.contact_forces import contact_forces


@pytest.fixture(scope="session")
def sim():
    """A robot that stands."""
    sim = AtlasSimulation()
    sim.advance(0.2)
    return sim


@pytest.fixture(scope="session")
def standing(sim):
    """Its record, with what is computed for views alone."""
    results, query = sim.output("contact_results"), sim.output("query_object")
    return replace(
        sim.record,
        paths=sim.output("planned_paths"),
        contacts=contact_forces(results, query.inspector()),
    )


@pytest.fixture(scope="session")
def record_of(standing):
    """Makes the record with other fields; of a group, those in a dictionary."""

    def record_of(**changes):
        for name, value in changes.items():
            part = getattr(standing, name)
            if isinstance(value, dict) and dataclasses.is_dataclass(part):
                changes[name] = replace(part, **value)
        return replace(standing, **changes)

    return record_of
