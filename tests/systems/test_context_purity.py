"""All state of a run is in its Context: contexts are independent of each other."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake import PlannedPush, Scenario, Start
from atlas_drake.diagrams.atlas_station import make_atlas_station
from atlas_drake.diagrams.control_mode_switch import make_control_mode_switch
from atlas_drake.messages import AtlasCommand, Behavior, accept
from atlas_drake.robot import load_robot
from atlas_drake.simulation.tutorial import walk_command
from atlas_drake.systems.command_scheduler import ScheduledCommand

WALK_AT = 0.05
"""When the robot is told to walk [s]."""
END = 0.1505
"""Of short runs [s], between two updates: at an update's own instant a simulator may
or may not have done it yet."""
STEPPING = 1.1005
"""Its first foot is in the air [s]."""


@pytest.fixture(scope="module")
def diagram(robot):
    """A robot with noisy sensors and shared joints that is about to walk."""
    arms = AtlasCommand()
    arms.k_effort = [0] * 16 + [255] * 6 + [100] * 6
    arms.ki_position = [5.0] * 28
    arms.i_effort_max = [3.0] * 28
    schedule = [
        ScheduledCommand(0.02, arms),
        ScheduledCommand(WALK_AT, walk_command),
    ]
    scenario = Scenario(noise="rough", seed=3, state="estimated")
    return make_control_mode_switch(robot, scenario, schedule)


@pytest.fixture
def start(diagram):
    """Makes a context with the robot on its feet."""
    return diagram.CreateDefaultContext


def remembered(diagram, context):
    """Every number in the context, and what the behaviors report, to the bit."""
    discrete = context.get_discrete_state()
    numbers = [discrete.get_vector(i).value() for i in range(discrete.num_groups())]
    estimates = ("estimated_state", "estimation_error")
    outputs = {
        name: diagram.GetOutputPort(name).Eval(context)
        for name in ("effort", "peaks", "imu", "atlas_state", "sent", *estimates)
    }
    report = diagram.GetOutputPort("atlas_sim_interface_state").Eval(context)
    status = diagram.GetOutputPort("controller_status").Eval(context)
    efforts = diagram.GetOutputPort("behavior_effort").Eval(context)
    return [
        context.get_time(),
        np.concatenate(numbers).tobytes(),
        *(outputs[name].tobytes() for name in ("effort", "peaks", *estimates)),
        outputs["imu"],
        outputs["atlas_state"],
        outputs["sent"],
        report,
        efforts.tobytes(),
        *(
            # A robot that falls has no plan.
            None if part is None else part.tobytes()
            for part in (status.plan.dcm_reference, status.plan.support)
        ),
        status.events,
        status.unsolved,
    ]


def test_a_context_knows_nothing_of_another_that_runs_in_turns(diagram, start):
    alone = Simulator(diagram, start())
    alone.AdvanceTo(END)
    expected = remembered(diagram, alone.get_context())

    first, second = Simulator(diagram, start()), Simulator(diagram, start())
    disturbance = AtlasCommand()
    disturbance.position = [0.5] * 28
    disturbance.k_effort = [200] * 28
    station = diagram.GetSubsystemByName("station")
    interface = station.GetSubsystemByName("command_interface")
    interface.receive(
        interface.GetMyMutableContextFromRoot(second.get_mutable_context()),
        accept(disturbance, load_robot()),
    )
    for k in range(1, 11):
        second.AdvanceTo(0.1 * k * END)
        first.AdvanceTo(END if k == 10 else 0.1 * k * END + 0.01)
    assert remembered(diagram, first.get_context()) == expected
    second.AdvanceTo(END)
    assert remembered(diagram, second.get_context()) != expected


def test_the_same_simulator_runs_the_same_again(diagram, start):
    simulator = Simulator(diagram, start())
    begin = simulator.get_context().Clone()
    runs = []
    for _ in range(2):
        simulator.Initialize()
        simulator.AdvanceTo(END)
        runs.append(remembered(diagram, simulator.get_context()))
        simulator.reset_context(begin.Clone())
    assert runs[0] == runs[1]


@pytest.mark.slow
def test_a_clone_in_mid_step_goes_on_as_the_original_does(diagram, start):
    original = Simulator(diagram, start())
    original.AdvanceTo(STEPPING)
    clone = Simulator(diagram, original.get_context().Clone())
    report = diagram.GetOutputPort("atlas_sim_interface_state")
    state = report.Eval(original.get_context())
    assert state.current_behavior is Behavior.WALK
    assert state.walk_feedback.status_flags & state.walk_feedback.WALK_SUBSTATE_STEPPING
    clone.AdvanceTo(STEPPING + 0.5)
    # Meanwhile the original has stood still; it is not where the clone is.
    before = remembered(diagram, original.get_context())
    assert before != remembered(diagram, clone.get_context())
    original.AdvanceTo(STEPPING + 0.5)
    assert remembered(diagram, original.get_context()) == remembered(
        diagram, clone.get_context()
    )
    index = report.Eval(clone.get_context()).walk_feedback.current_step_index
    assert index >= 1


def test_a_clone_amid_a_push_in_the_gantry_goes_on_alike(robot):
    """What pushes and holds the robot is in the Context, too."""
    pushes = [
        PlannedPush(time=0.02, impulse=8.0, duration=0.1),
        PlannedPush(time=0.035, impulse=5.0, body="pelvis", duration=0.03),
    ]
    scenario = Scenario(
        pushes=pushes, start=Start(on_gantry=True), initial_behavior="FREEZE"
    )
    station = make_atlas_station(robot, scenario)

    def held(root):
        plant = station.GetSubsystemByName("plant")
        X_WP = plant.EvalBodyPoseInWorld(
            plant.GetMyContextFromRoot(root), plant.GetBodyByName("pelvis")
        )
        gantry = station.GetSubsystemByName("gantry")
        context = gantry.GetMyMutableContextFromRoot(root)
        p_WP, R_WP = X_WP.translation(), X_WP.rotation().matrix()
        gantry.hold(context, p_WP, R_WP, 0.1, released=0.05)

    first = Simulator(station)
    held(first.get_mutable_context())
    first.AdvanceTo(0.0305)
    pushes = station.GetOutputPort("pushes").Eval(first.get_context())
    assert [push.body for push in pushes.active] == [robot.file.chest, "pelvis"]
    second = Simulator(station, first.get_context().Clone())
    ends = []
    for simulator in (first, second):
        simulator.AdvanceTo(0.0905)
        root = simulator.get_context()
        ends.append([station.GetOutputPort(n).Eval(root) for n in ("state", "pushes")])
        assert station.GetOutputPort("gantry").Eval(root).released == 0.05
    assert (ends[0][0] == ends[1][0]).all()
    assert ends[0][1].begun == ends[1][1].begun == 2
