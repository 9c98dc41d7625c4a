"""What the page may ask of a run, and what it is shown."""

import base64
import threading

import msgpack
import numpy as np
import orjson
import pytest

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    PolicyUse,
    Scenario,
)
from atlas_drake.clients.cockpit.clock import KEPT_EVERY
from atlas_drake.clients.cockpit.cockpit import Cockpit
from atlas_drake.clients.cockpit.recording import ANIMATION, MESSAGE, Recording
from atlas_drake.clients.cockpit.run_page import RunPage, why_refused
from atlas_drake.clients.cockpit.wire import Answer, Frame, Request
from atlas_drake.clients.view import FRAME_RATE
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.errors import AtlasError
from tests.policy_networks import ARM, METADATA, save

from .conftest import Asked

FREEZE = {"atlas_sim_interface_command": {"behavior": "FREEZE"}}


@pytest.mark.parametrize(
    ("request_", "values"),
    [
        ("message", {"atlas_command": {"k_effort": 256}}),
        ("message", {"atlas_command": {"k_effort": "all"}}),
        ("message", {"atlas_command": {"position": [1.0, 2.0]}}),
        ("message", {"atlas_command": {"strength": 1}}),
        ("message", {"atlas_sim_interface_command": {"behavior": "FLY"}}),
        ("message", {"atlas_sim_interface_command": [1]}),
        ("message", {}),
        ("fly", {}),
        ("__init__", {}),
        ("seek", {"time": 1.0}),
        ("pause", {}),
        ("pause", {"on": "yes"}),
        ("pause", {"on": 1}),
        ("pause", {"on": True, "now": 1}),
        ("rate", {"rate": True}),
        ("push", {"body": "utorso", "impulse_W": [1, 2, None]}),
        ("check", {"changes": {"seed": 1}}),
        ("rate", {"rate": -5.0}),
        ("rate", {"rate": float("nan")}),
        ("reset", {"seed": -1}),
        ("back", {"seconds": 10.0}),
        ("push", {"body": "utorso", "impulse_W": [1.0, 2.0]}),
        ("push", {"body": "utorso", "impulse_W": [1e6, 0.0, 0.0]}),
        ("push", {"body": "nose", "impulse_W": [1.0, 0.0, 0.0]}),
        ("show", {"overlay": "x-ray", "on": True}),
        ("show", {"overlay": ["com"], "on": True}),
        ("show", {"overlay": "com", "on": "yes"}),
        ("record", {"on": False}),
        ("check", {"changes": {"physics_step": "much"}}),
    ],
)
def test_what_cannot_be_used_is_refused_and_changes_nothing(run, request_, values):
    before = run.sim.output("commands").received
    with pytest.raises((AtlasError, ValueError)):
        run.do(request_, **values)
    assert run.sim.output("commands").received == before
    run.sim.advance(0.04)
    assert run.sim.current_behavior is Behavior.STAND


def test_a_policy_is_steered_taken_and_watched(tmp_path, meshcat, next_run):
    file = save(tmp_path / "arm.onnx", [0.0, 0.0], metadata=METADATA)
    use = PolicyUse(file=str(file), start=0.0, fastest=[0.5, 0.2, 1.0])
    sim = AtlasSimulation(Scenario(policy=use))
    recording = Recording(meshcat)
    run = Asked(RunPage(sim, meshcat, Overlays(), next_run, recording), sim)
    sim.advance(0.1)
    run.do("steer_policy", forward=1.0, left=0.0, turn=-0.5)
    run.do("watch_policy", on=True)
    shown = run.shown()["policy"]
    assert shown["runs"]
    assert shown["watched"]
    assert shown["velocity"] == [0.5, 0.0, -0.5]
    assert [sim.robot.joint_names[i] for i in shown["joints"]] == list(ARM)
    assert run.page.frame().steered_policy == (1.0, 0.0, -0.5)
    run.do("message", atlas_command={"k_effort": 0})
    sim.advance(0.1)
    assert run.page.frame().steered_policy is None
    run.do("take_policy")
    assert run.shown()["policy"]["runs"]
    with pytest.raises(AtlasError):
        run.do("steer_policy", forward=2.0, left=0.0, turn=0.0)


def test_messages_have_the_form_of_a_scenario(run):
    run.do("message", atlas_command={"k_effort": [0] * 27 + [90]})
    assert run.shown()["command"]["k_effort"] == [0] * 27 + [90]
    desired = {"pelvis_height": 0.8}
    run.do(
        "message",
        atlas_sim_interface_command={
            "behavior": "MANIPULATE",
            "manipulate_params": {"use_desired": True, "desired": desired},
        },
    )
    run.sim.advance(0.1)
    shown = run.shown()
    assert shown["behavior"] == "MANIPULATE"
    assert shown["record"]["manipulate"]["clamped"]["pelvis_height"] == 0.8


def test_a_push_tells_what_it_changes(run):
    change = run.do("push", body="utorso", impulse_W=[9.0, 0.0, 0.0])
    assert change == pytest.approx(9.0 / run.sim.robot.mass)
    assert run.sim.output("pushes").begun == 1


def test_time_is_paused_stepped_and_paced(run):
    clock = run.page.clock
    run.do("step")
    assert clock.paused
    assert clock.takes_step()
    assert not clock.takes_step()
    assert run.shown()["paused"]
    assert run.shown()["rate"] == 0.0
    run.do("pause", on=False)
    assert not clock.paused
    run.do("rate", rate=2.0)
    assert run.shown()["pace"] == 2.0
    run.do("rate", rate=0.0)


@pytest.mark.slow
def test_time_goes_back_to_what_was(run):
    clock, sim = run.page.clock, run.sim
    clock.keep_snapshot()
    sim.advance(KEPT_EVERY)
    clock.keep_snapshot()
    state = sim.output("state").copy()
    run.do("message", **FREEZE)
    sim.advance(0.2)
    assert run.do("back", seconds=0.1) == pytest.approx(KEPT_EVERY)
    assert np.array_equal(sim.output("state"), state)
    assert sim.current_behavior is Behavior.STAND
    assert run.do("back", seconds=10.0) == 0.0


def test_frames_show_the_run_and_each_event_once(run):
    run.page.frame()
    run.do("message", **FREEZE)
    run.sim.advance(0.1)
    frame = run.page.frame()
    assert [kind for _, kind, _ in frame.events] == ["behavior"]
    assert run.page.frame().events == ()
    shown = orjson.loads(frame.page)
    weight = 9.81 * run.sim.robot.mass
    assert sum(shown["loads"]) == pytest.approx(weight, rel=0.25)
    assert shown["record"]["joints"]["position"] == pytest.approx(
        run.sim.record.joints.position
    )


def test_every_column_has_its_place_in_the_record(run):
    described = orjson.loads(run.page.described().page)
    record, units = run.shown()["record"], run.sim.schema.units
    for name in ("balance.com.y", "joints.effort.l_leg_kny", "feet.left_force.z"):
        column, value = described["columns"][name], record
        for key in column["path"]:
            value = value[key]
        group, field, label = name.split(".")
        numbers = getattr(getattr(run.sim.record, group), field)
        labels = run.sim.schema.parts[group][field].elements
        assert value == numbers[labels.index(label)]
        assert column["unit"] == units[name]
    assert described["columns"].keys() >= units.keys()


def test_jumps_of_time_are_told_and_the_events_come_again(run):
    sim, before = run.sim, run.page.frame().run
    run.page.clock.keep_snapshot()
    run.do("message", **FREEZE)
    sim.advance(0.1)
    assert run.page.frame().run == before
    snapshot = sim.snapshot()
    run.do("reset")
    frame = run.page.frame()
    assert frame.run == before + 1
    assert [kind for _, kind, _ in frame.events] == ["behavior", "reset"]
    run.do("back")
    assert run.page.frame().run == before + 2
    assert run.page.frame().events == ()
    sim.restore(snapshot)  # By the program itself.
    run.page.frame()
    sim.reset(seed=1)
    assert run.page.frame().run == before + 3


def test_a_behavior_that_would_be_refused_says_why(run):
    assert not run.shown()["refusals"]["WALK"]
    run.do("message", **FREEZE)
    run.sim.advance(0.04)
    why = run.shown()["refusals"]["MANIPULATE"]
    assert why == "MANIPULATE may follow STAND, not FREEZE"


def test_a_fallen_robot_says_what_failed_first_and_needs_a_reset(run):
    sim = run.sim
    stand = sim.behaviors.entry(Behavior.STAND)
    assert "reset" in why_refused(stand, stand, sim.behaviors, fallen=True)
    assert not why_refused(stand, stand, sim.behaviors, fallen=False)
    run.do("push", body="utorso", impulse_W=[400.0, 0.0, 0.0])
    while not sim.has_fallen:
        assert run.shown()["failure"] is None
        sim.advance(0.02)
        run.page.watch()
    shown = run.shown()
    assert shown["fallen"]
    assert " at " in shown["failure"]
    run.do("reset")
    assert not run.shown()["fallen"]


def test_the_view_is_recorded_into_a_page(run):
    run.sim.advance(0.3)
    run.do("record", on=True)
    assert run.shown()["recording"]
    run.sim.advance(0.3)
    page = run.do("record", on=False)
    assert not run.shown()["recording"]
    (animation,) = [
        msgpack.unpackb(base64.b64decode(one[2]), strict_map_key=False)
        for one in MESSAGE.finditer(page)
        if one[2].startswith(ANIMATION)
    ]
    head = next(
        one for one in animation["animations"] if one["path"].endswith("atlas/head")
    )
    frames = [key["time"] for key in head["clip"]["tracks"][0]["keys"]]
    assert frames[:3] == [0, 1, 2]
    assert frames[-1] == pytest.approx(0.3 * FRAME_RATE, abs=1.5)


def test_a_schedule_is_dropped_by_who_takes_over(run):
    run.do("take_over")
    assert run.sim.events == []  # There was none.


class Line:
    """The simulation's end of a line whose other end is in the test's hand."""

    is_open = True

    def __init__(self):
        self.come, self.sent = [], []

    def send(self, value):
        self.sent.append(value)

    def take(self, most, timeout=0.0):
        taken, self.come = self.come[:most], self.come[most:]
        return taken


@pytest.fixture
def line(monkeypatch):
    """A line in the place of a page's process."""
    line = Line()
    line.come = ["http://localhost:8080/"]
    module = "atlas_drake.clients.cockpit.cockpit"
    monkeypatch.setattr(f"{module}.start_process", lambda *_arguments: (line, None))
    monkeypatch.setattr(f"{module}._end", lambda *_ends: None)
    return line


def test_the_effect_of_a_request_is_shown_before_its_answer(line):
    cockpit = Cockpit()
    sim = AtlasSimulation()
    cockpit.join(sim)
    line.sent.clear()
    line.come = [
        1,
        Request(1, "message", {"atlas_command": {"k_effort": 7}}),
        Request(0, "message", {"atlas_command": {"k_effort": 8}}),
        Request(2, "fly"),
        Request(3, "pause", {"off": True}),
        Request(4, "back"),
    ]
    sim.advance(0.02)
    frame, *answers = line.sent
    assert isinstance(frame, Frame)
    assert set(frame.reports.command.k_effort) == {8}
    assert all(isinstance(answer, Answer) for answer in answers)
    assert [answer.number for answer in answers] == [1, 2, 3, 4]
    assert not answers[0].problem
    assert "fly" in answers[1].problem
    assert "pause" in answers[2].problem


@pytest.mark.slow
def test_requests_are_met_in_a_pause_which_ends_with_the_program(line):
    cockpit = Cockpit()
    sim = AtlasSimulation()
    cockpit.join(sim)
    stop = threading.Event()
    cockpit.asked_to_stop = stop.is_set
    line.come = [Request(1, "pause", {"on": True})]
    freeze = Request(2, "message", FREEZE)
    threading.Timer(0.2, lambda: line.come.append(freeze)).start()
    threading.Timer(0.5, stop.set).start()
    sim.advance(0.02)
    answered = [one.number for one in line.sent if isinstance(one, Answer)]
    assert answered == [1, 2]
    cockpit.asked_to_stop = lambda: False
    line.come = [Request(3, "pause", {"on": False})]
    sim.advance(0.1)
    assert sim.current_behavior is Behavior.FREEZE


@pytest.mark.slow
def test_frames_wait_for_a_page_that_takes_them(line):
    cockpit = Cockpit()
    sim = AtlasSimulation()
    cockpit.join(sim)
    line.sent.clear()
    sim.advance(0.3)
    assert line.sent == []  # Nobody looks.
    line.come = [1]
    sim.advance(1.0)
    assert len([one for one in line.sent if isinstance(one, Frame)]) == 1


def test_a_command_of_the_program_is_no_jump(run):
    before = run.page.frame().run
    run.sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.FREEZE))
    run.sim.advance(0.1)
    assert run.page.frame().run == before
