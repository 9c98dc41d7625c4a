"""A replay shows the contents of the log in the same way as the run."""

import dataclasses
from dataclasses import asdict, dataclass, replace

import numpy as np
import pytest
from pydrake.common.yaml import yaml_dump
from pydrake.geometry import Meshcat
from pydrake.systems.analysis import Simulator

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    LogError,
    Scenario,
    read_log,
)
from atlas_drake.behaviors.base import BehaviorProtocol
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.checked import as_plain
from atlas_drake.control.wrenches import center_of_pressure
from atlas_drake.diagrams.replay import make_replay
from atlas_drake.logs.layout import SIDES
from atlas_drake.logs.log import Log
from atlas_drake.logs.log_player import LogPlayer
from atlas_drake.logs.notes import Header
from atlas_drake.scenario.terrain import Block
from atlas_drake.visualization.caption import caption_of, feedback_words
from atlas_drake.visualization.footsteps import footstep_marks
from atlas_drake.visualization.overlay_marks import PATH
from atlas_drake.visualization.overlays import LOGGED, Overlays

from .conftest import ARM, walk_command

FEEDBACK = (
    "error_code",
    "current_behavior",
    "desired_behavior",
    "f_out",
    "behavior_feedback",
    "stand_feedback",
    "step_feedback",
    "walk_feedback",
    "manipulate_feedback",
    "k_effort",
)
"""What of a report changes in control ticks alone."""
NAMES = (
    "commands",
    "controller_status",
    "atlas_sim_interface_state",
    "planned_paths",
)


@pytest.fixture(scope="module")
def meshcat():
    return Meshcat()


def geometry_poses(query):
    inspector = query.inspector()
    return {
        inspector.GetName(frame): query.GetPoseInWorld(frame).GetAsMatrix4()
        for frame in inspector.GetAllFrameIds()
    }


def test_bodies_are_where_the_log_has_them(run, meshcat):
    sim, log = run
    diagram = make_replay(log, meshcat)
    context = diagram.CreateDefaultContext()
    station = diagram.GetSubsystemByName("station")
    own = station.GetMyContextFromRoot(context)
    plant = sim.plant
    scratch = plant.CreateDefaultContext()
    for row in (0, len(log) // 2, len(log) - 1):
        context.SetTime(log.time[row])
        poses = geometry_poses(station.GetOutputPort("query_object").Eval(own))
        plant.SetPositions(scratch, log["state.q"][row])
        for name in sim.robot.body_names:
            X_WB = plant.EvalBodyPoseInWorld(scratch, plant.GetBodyByName(name))
            np.testing.assert_allclose(
                poses[f"atlas::{name}"], X_WB.GetAsMatrix4(), atol=1e-12
            )


def test_the_row_is_the_latest_one(log):
    player, period = LogPlayer(log), log.header.control_period
    context = player.CreateDefaultContext()
    for time, row in (
        (0.0, 0),
        (1.5 * period, 1),
        (2.0 * period, 2),
        (99.0, len(log) - 1),
    ):
        context.SetTime(time)
        assert player.row(context) == row
        np.testing.assert_array_equal(
            player.GetOutputPort("state").Eval(context),
            np.concatenate([log["state.q"][row], log["state.v"][row]]),
        )


def test_footsteps_and_caption_are_those_of_the_run(run):
    sim, log = run
    live = [sim.output(name) for name in NAMES]
    player = LogPlayer(log)
    context = player.CreateDefaultContext()
    context.SetTime(log.time[-1])
    again = [player.GetOutputPort(name).Eval(context) for name in NAMES]

    def seen(commands, status, report, _paths):
        events = status.events
        return footstep_marks(
            commands.request, report, events, status.plan
        ), caption_of(report)

    marks, caption = seen(*again)
    assert (marks, caption) == seen(*live)
    was, is_now = live[1].plan, again[1].plan
    for name in ("support", "dcm_reference", "cop_reference"):
        np.testing.assert_allclose(getattr(is_now, name), getattr(was, name))
    assert [step.foot for step in is_now.footsteps] == [
        step.foot for step in was.footsteps
    ]
    assert is_now.footsteps
    # Paths are kept every 0.1 s; where they end moves little meanwhile.
    for name in ("com", "dcm", "cop"):
        end, ended = getattr(again[3], name)[-1], getattr(live[3], name)[-1]
        np.testing.assert_allclose(end, ended, atol=0.01)
    for name in FEEDBACK:
        assert getattr(again[2], name) == getattr(live[2], name), name
    assert len(marks) >= 4
    assert caption[0].startswith("WALK")
    assert again[0].request.command == walk_command()


def test_a_replay_shows_the_robot_and_what_the_log_is_enough_for(log):
    meshcat, overlays = Meshcat(), Overlays(LOGGED)
    simulator = Simulator(make_replay(log, meshcat, overlays))
    for name in ("owner", "effort"):
        overlays.switch(name, True)
        simulator.AdvanceTo(simulator.get_context().get_time() + 0.05)
    assert meshcat.HasPath("/drake/visualizer/atlas/pelvis")
    for mark in ("com_ball", "dcm", "cop", "support/0"):
        assert meshcat.HasPath(f"{PATH}/{mark}")
    assert not meshcat.HasPath(f"{PATH}/forces")
    simulator.AdvanceTo(log.time[-1])
    assert meshcat.HasPath("/atlas_drake/footsteps/0")


def test_displays_read_what_they_read_in_the_run(run):
    sim, log = run
    player = LogPlayer(log)
    context = player.CreateDefaultContext()
    # The push and the user's arm are in force.
    context.SetTime(0.11)
    commands = player.GetOutputPort("commands").Eval(context)
    assert commands.k_effort[ARM] == 255.0
    wrenches = player.GetOutputPort("foot_wrenches").Eval(context)
    weight = wrenches[5] + wrenches[11]
    assert weight == pytest.approx(9.81 * sim.robot.mass, rel=0.3)
    row = player.row(context)
    soles = [log[f"feet.{side}_position"][row] for side in SIDES]
    cop = center_of_pressure(soles, wrenches)[:2]
    np.testing.assert_array_equal(cop, log["balance.cop"][row])
    effort = player.GetOutputPort("effort").Eval(context)
    np.testing.assert_array_equal(effort, log["joints.effort"][row])


def test_terrain_is_shown(log, scenario, meshcat):
    rough = dataclasses.replace(scenario, terrain=[Block()])
    text = yaml_dump(as_plain(rough))
    header = Header("atlas", 0.002, text, log.header.layout)
    terrain = Log(log.path, header, log.arrays, log.notes)
    diagram = make_replay(terrain, meshcat)
    station = diagram.GetSubsystemByName("station")
    inspector = station.GetSubsystemByName("scene_graph").model_inspector()
    names = [inspector.GetName(key) for key in inspector.GetAllGeometryIds()]
    assert any("terrain_0" in name for name in names)


def test_a_scenario_of_another_time_is_named(log, meshcat):
    header = Header("atlas", 0.002, "gravity: up\n", log.header.layout)
    with pytest.raises(LogError, match="scenario"):
        make_replay(Log(log.path, header, log.arrays, log.notes), meshcat)


def test_a_log_that_kept_less_is_refused(log):
    arrays = {n: a for n, a in log.arrays.items() if n != "manipulate.clamped"}
    with pytest.raises(LogError, match=r"without manipulate\.clamped"):
        LogPlayer(Log(log.path, log.header, arrays, log.notes))


@pytest.mark.parametrize("behavior", ["STEP", "MANIPULATE"])
def test_other_behaviors_look_as_in_the_run(behavior, tmp_path):
    command = AtlasSimInterfaceCommand()
    command.behavior = behavior
    step = command.step_params.desired_step
    step.step_index, step.duration, step.swing_height = 1, 0.7, 0.1
    step.pose.position.x, step.pose.position.y = 0.1, 0.14
    command.manipulate_params.use_desired = True
    command.manipulate_params.desired.pelvis_height = 0.75
    sim = AtlasSimulation(Scenario(state="estimated"), log=tmp_path / "run.npz")
    sim.publish(command)
    sim.advance_to(0.1)
    live = [sim.output(name) for name in NAMES]
    sim.close()
    log = read_log(tmp_path / "run.npz")
    assert np.isfinite(log["balance.dcm_reference"]).all()
    # The behaviors see the estimate, and so do the log's pelvis and feet.
    assert (log["pelvis.position"][10:] != log["state.q"][10:, 4:7]).any()
    player = LogPlayer(log)
    context = player.CreateDefaultContext()
    context.SetTime(log.time[-1])
    again = [player.GetOutputPort(name).Eval(context) for name in NAMES]
    looks = [
        (
            footstep_marks(c.request, report, state.events, state.plan),
            caption_of(report),
            feedback_words(report),
        )
        for c, state, report, _paths in (live, again)
    ]
    assert looks[0] == looks[1]
    marks, caption, words = looks[0]
    assert caption[0].startswith(behavior)
    assert len(marks) == (1 if behavior == "STEP" else 0)
    assert words != "ok"
    for name in FEEDBACK:
        assert getattr(again[2], name) == getattr(live[2], name), name
    feedback = again[2].manipulate_feedback
    moved = feedback.internal_sensed.pelvis_height != 0.8
    assert moved == (behavior == "MANIPULATE")


@dataclass(frozen=True)
class Waited:
    """Feedback of the behavior below."""

    ticks: int
    mood: str = "calm"


class Waiting(BehaviorProtocol):
    """Holds the pose and counts its ticks."""

    def __init__(self, tools, config):
        self._freeze = tools.freeze

    def enter(self, *given):
        return (0, self._freeze.enter(*given))

    def update(self, state, *given, leaving):
        outcome = self._freeze.update(state[1], *given, leaving=leaving)
        return replace(outcome, state=(state[0] + 1, outcome.state))

    def feedback(self, state, status_flags):
        return Waited(state[0] // 4)


@pytest.mark.parametrize("ending", ["npz", "mcap"])
def test_feedback_of_ones_own_behavior_is_logged_and_replayed(tmp_path, ending):
    entry = BehaviorEntry(name="WAIT", number=100, make=Waiting)
    path = tmp_path / f"run.{ending}"
    with AtlasSimulation(behaviors=[entry], log=path) as sim:
        sim.advance(0.05)
        sim.publish(AtlasSimInterfaceCommand(behavior="WAIT"))
        sim.advance(0.1)
        last = sim.atlas_sim_interface_state.feedback
        sim.publish(AtlasSimInterfaceCommand(behavior="FREEZE"))
        sim.advance(0.05)
    log = read_log(path)
    notes = [note.data["feedback"] for note in log.notes if note.kind == "feedback"]
    ticks = range(last.ticks + 1)
    assert notes == [*({"ticks": n, "mood": "calm"} for n in ticks), None]
    player = LogPlayer(log)
    context = player.CreateDefaultContext()
    reported = []
    for time in (0.03, 0.14, 0.19):
        context.SetTime(time)
        report = player.GetOutputPort("atlas_sim_interface_state").Eval(context)
        reported.append(report.feedback)
    assert reported == [None, asdict(last), None]
