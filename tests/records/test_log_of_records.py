"""Records come back from a log as they were, whatever they hold."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from atlas_drake import read_log
from atlas_drake.clients.logs.header import Header
from atlas_drake.clients.logs.mcap_writer import McapWriter
from atlas_drake.frozen import replace
from atlas_drake.messages import (
    AtlasSimInterfaceCommand,
    Behavior,
)
from atlas_drake.messages.behavior_catalog import SHIPPED
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.messages.event import FOOTSTEP, FOOTSTEP_DATA, MESSAGE, Event
from atlas_drake.messages.footstep import Footstep
from atlas_drake.records import Schema, TickRecord
from atlas_drake.records.column import XYZ, Names
from atlas_drake.records.schema import GROUPS, OPTIONAL
from atlas_drake.records.tick_record import ContactForce, landed_among
from atlas_drake.systems.interface_reporter import FEEDBACK_FIELDS
from tests.filled import changed

SPECIAL = (0.0, -0.0, 5e-324, -1e308, 0.1, 1.0, float("nan"))
FINITE = st.floats(allow_nan=False, allow_infinity=False)
TEXT = st.text(max_size=8)
TIMES = st.floats(0.0, 1e6)
PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**53), 2**63 - 1) | FINITE | TEXT,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(TEXT, inner, max_size=3)
    ),
    max_leaves=6,
)
"""What a user's own feedback, plan or event may hold, as plain data."""
VECTOR = st.tuples(FINITE, FINITE, FINITE)
FOOTSTEPS = st.builds(
    Footstep,
    index=st.integers(1, 99),
    foot=st.integers(0, 1),
    p_WF=VECTOR,
    yaw=FINITE,
    duration=FINITE,
    swing_height=FINITE,
    normal=VECTOR.map(np.array),
    relative=st.booleans(),
)
PATHS = st.builds(
    PlannedPaths,
    com=st.none() | st.lists(st.tuples(FINITE, FINITE), min_size=1, max_size=3),
    swing=st.none() | st.lists(VECTOR, min_size=1, max_size=3),
)
CONTACTS = st.builds(ContactForce, VECTOR.map(np.array), VECTOR.map(np.array))
LANDINGS = st.builds(
    Event,
    TIMES,
    st.just(FOOTSTEP),
    TEXT,
    st.fixed_dictionaries(dict.fromkeys(FOOTSTEP_DATA, PLAIN)),
)
OTHERS = st.builds(
    Event,
    FINITE,
    TEXT.filter(lambda kind: kind not in (MESSAGE, FOOTSTEP)),
    TEXT,
    st.dictionaries(TEXT, PLAIN, max_size=3),
)


def schema_of(groups):
    """Two joints on a floating base, and a ball beside."""
    labels = {
        Names.JOINTS: ("hip", "knee"),
        Names.POSITIONS: ("qw", "qx", "qy", "qz", "x", "y", "z", "hip", "knee"),
        Names.VELOCITIES: ("wx", "wy", "wz", "vx", "vy", "vz", "hip", "knee"),
        Names.WORLD_POSITIONS: ("ball_x",),
        Names.WORLD_VELOCITIES: ("ball_vx", "ball_vy"),
        Names.CONTACT_PAIRS: tuple(f"hip-{one}.{axis}" for one in "ab" for axis in XYZ),
    }
    kept = (name for name in GROUPS if name not in OPTIONAL or name in groups)
    return Schema(labels, tuple(kept))


def value_of(column, random):
    """A value of a column: a number, an array, or None where it may be missing."""
    if column.optional and random.random() < 0.3:
        return None
    size = max(len(column.labels), 1)
    if column.kind == "u1":
        return random.integers(0, 256, size).astype(float)
    if column.kind != "f8":
        return int(random.integers(-(2**50), 2**50))
    if column.width:
        rows = random.integers(1, size // column.width + 1)
        return random.normal(size=(rows, column.width))
    numbers = random.normal(size=size) * 10.0 ** random.integers(-300, 300, size)
    special = random.random(size) < 0.3
    numbers = np.where(special, random.choice(SPECIAL, size), numbers)
    if column.optional:
        numbers[0] = 1.0  # Nothing but NaN would be None.
    return numbers if column.labels else numbers.item()


def group_of(schema, name, random):
    parts = {
        field: value_of(schema.columns[f"{name}.{field}"], random)
        for field in GROUPS[name].columns()
    }
    group = GROUPS[name](**parts)
    if name == "behavior":
        entries = [entry.behavior for entry in SHIPPED]
        current = int(entries[random.integers(len(entries))])
        return replace(group, current=current, request_number=0)
    if name == "state":
        # Reading checks that the pelvis has a pose.
        return replace(group, q=np.append([1.0, 0.0, 0.0, 0.0], random.normal(size=5)))
    return group


def message_of(kind, random):
    """A message with random numbers in all fields."""

    def other(value):
        if isinstance(value, bool):
            return bool(random.integers(2))
        if isinstance(value, int):
            return int(random.integers(-(2**40), 2**40))
        return float(random.normal()) if isinstance(value, float) else value

    return changed(kind(), other)


@st.composite
def runs(draw):
    """The schema and the records of a run."""
    schema = schema_of(draw(st.sets(st.sampled_from(sorted(OPTIONAL)))))
    random = np.random.default_rng(draw(st.integers(0, 2**32)))
    times = sorted(draw(st.lists(TIMES, min_size=1, max_size=4)))
    records, landings, request, received = [], [], None, 0
    for time in times:
        events = [*draw(st.lists(LANDINGS | OTHERS, max_size=2))]
        landings += (event for event in events if event.kind == FOOTSTEP)
        if draw(st.booleans()):
            received += 1
            message = message_of(AtlasSimInterfaceCommand, random)
            message.behavior = Behavior.WALK
            request = received, message.freeze()
            data = {"number": received, "message": message}
            name = type(message).__name__
            events.append(Event(draw(TIMES), MESSAGE, name, data))
        groups = {name: group_of(schema, name, random) for name in schema.groups}
        in_force = request or (0, None)
        groups["behavior"] = replace(groups["behavior"], request_number=in_force[0])
        kinds = {name: kind for kind, name in FEEDBACK_FIELDS.items()}
        told = draw(st.sets(st.sampled_from(sorted(kinds)), max_size=1))
        records.append(
            TickRecord(
                time=time,
                request=in_force[1],
                **groups,
                **{name: message_of(kinds[name], random) for name in told},
                feedback=draw(PLAIN),
                plan=draw(st.dictionaries(TEXT, PLAIN, max_size=2)),
                footsteps=tuple(draw(st.lists(FOOTSTEPS, max_size=2))),
                landed=landed_among(landings),
                pushes=tuple(draw(st.lists(st.tuples(TEXT, VECTOR), max_size=2))),
                events=tuple(events),
                paths=draw(st.none() | PATHS),
                contacts=draw(st.none() | st.lists(CONTACTS, max_size=2).map(tuple)),
            )
        )
    return schema, records


@settings(max_examples=12, deadline=None)
@given(run=runs())
def test_records_come_back_from_a_log(tmp_path_factory, run):
    schema, records = run
    path = tmp_path_factory.mktemp("records") / "records.mcap"
    writer = McapWriter(path)
    writer.begin(Header({}), schema)
    for record in records:
        writer.record(record)
    writer.close()
    log = read_log(path)
    assert log.schema == schema
    assert [*log.records()] == records
