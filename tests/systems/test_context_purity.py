"""All state of a run is in its Context: contexts are independent of each other."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake import PlannedPush, Scenario, Start
from atlas_drake.diagrams.atlas_station import make_atlas_station
from atlas_drake.diagrams.control_mode_switch import make_control_mode_switch
from atlas_drake.messages import AtlasCommand, accept
from atlas_drake.robot import load_robot
from atlas_drake.simulation.tutorial import walk_command
from atlas_drake.systems.command_scheduler import ScheduledCommand
from atlas_drake.systems.sensor_noise import NOISE_MODELS

END = 0.1505
"""Of short runs [s], between two updates: at an update's own instant a simulator may
or may not have done it yet."""
VECTORS = ("effort", "peaks", "behavior_effort", "estimation_error")
VALUES = ("imu", "atlas_state", "sent", "atlas_sim_interface_state", "record")
STEPPING = 1.1005
"""The first foot of a walk is in the air [s]."""


@pytest.fixture(scope="module")
def diagram(robot):
    """A robot with noisy sensors and motors, and shared joints, is about to walk."""
    arms = AtlasCommand()
    arms.k_effort = [0] * 16 + [255] * 6 + [100] * 6
    arms.ki_position = [5.0] * 28
    arms.i_effort_max = [3.0] * 28
    schedule = [ScheduledCommand(0.02, arms), ScheduledCommand(0.05, walk_command)]
    noise = replace(NOISE_MODELS["rough"], effort=0.002)
    scenario = Scenario(noise=noise, effort_delay=0.003, seed=3, state="estimated")
    return make_control_mode_switch(robot, scenario, schedule)


def remembered(diagram, simulator):
    """Every number in the context, and what the behaviors report, to the bit."""
    context = simulator.get_context()
    discrete = context.get_discrete_state()
    numbers = [discrete.get_vector(i).value() for i in range(discrete.num_groups())]
    vectors, values = (
        [diagram.GetOutputPort(name).Eval(context) for name in names]
        for names in (VECTORS, VALUES)
    )
    return [context.get_time(), np.concatenate([*numbers, *vectors]).tobytes(), *values]


@pytest.mark.slow
def test_contexts_that_run_in_turns_know_nothing_of_each_other(diagram):
    alone = Simulator(diagram)
    begin = alone.get_context().Clone()
    alone.AdvanceTo(END)
    expected = remembered(diagram, alone)

    first, second = Simulator(diagram), Simulator(diagram)
    disturbance = AtlasCommand(position=[0.5] * 28, k_effort=[200] * 28)
    station = diagram.GetSubsystemByName("station")
    interface = station.GetSubsystemByName("command_interface")
    interface.receive(
        interface.GetMyMutableContextFromRoot(second.get_mutable_context()),
        accept(disturbance, load_robot()),
    )
    for k in range(1, 11):
        second.AdvanceTo(0.1 * k * END)
        first.AdvanceTo(END if k == 10 else 0.1 * k * END + 0.01)
        diagram.GetOutputPort("record").Eval(first.get_context())  # Changes nothing.
        if k == 5:
            first = Simulator(diagram, first.get_context().Clone())
    assert remembered(diagram, first) == expected
    assert remembered(diagram, second) != expected
    # The same simulator runs the same again.
    alone.reset_context(begin)
    alone.Initialize()
    alone.AdvanceTo(END)
    assert remembered(diagram, alone) == expected


@pytest.mark.slow
def test_a_clone_in_mid_step_goes_on_as_the_original_does(diagram):
    original = Simulator(diagram)
    original.AdvanceTo(STEPPING)
    clone = Simulator(diagram, original.get_context().Clone())
    report = diagram.GetOutputPort("atlas_sim_interface_state")
    walk = report.Eval(original.get_context()).walk_feedback
    assert walk.status_flags & walk.WALK_SUBSTATE_STEPPING
    clone.AdvanceTo(STEPPING + 0.5)
    # Meanwhile the original has stood still; it is not where the clone is.
    assert remembered(diagram, original) != remembered(diagram, clone)
    original.AdvanceTo(STEPPING + 0.5)
    assert remembered(diagram, original) == remembered(diagram, clone)
    assert report.Eval(clone.get_context()).walk_feedback.current_step_index >= 1


def test_a_clone_amid_a_push_on_the_gantry_goes_on_alike(robot):
    """What pushes and holds the robot is in the Context, too."""
    pushes = [
        PlannedPush(time=0.02, impulse=8.0, duration=0.1),
        PlannedPush(time=0.035, impulse=5.0, body="pelvis", duration=0.03),
    ]
    scenario = Scenario(
        pushes=pushes, start=Start(on_gantry=True), initial_behavior="FREEZE"
    )
    station = make_atlas_station(robot, scenario)
    first = Simulator(station)
    root = first.get_mutable_context()
    plant = station.GetSubsystemByName("plant")
    X_WP = plant.EvalBodyPoseInWorld(
        plant.GetMyContextFromRoot(root), plant.GetBodyByName("pelvis")
    )
    gantry = station.GetSubsystemByName("gantry")
    gantry.hold(
        gantry.GetMyMutableContextFromRoot(root),
        X_WP.translation(),
        X_WP.rotation().matrix(),
        0.1,
        released=0.05,
    )
    first.AdvanceTo(0.0305)
    pushes = station.GetOutputPort("pushes").Eval(root)
    assert [push.body for push in pushes.active] == [robot.file.chest, "pelvis"]
    second = Simulator(station, root.Clone())
    ends = []
    for simulator in (first, second):
        simulator.AdvanceTo(0.0905)
        root = simulator.get_context()
        ends.append([station.GetOutputPort(n).Eval(root) for n in ("state", "pushes")])
        assert station.GetOutputPort("gantry").Eval(root).released == 0.05
    assert (ends[0][0] == ends[1][0]).all()
    assert ends[0][1].begun == ends[1][1].begun == 2
