"""The fall of a robot, detected from the true state of a station by itself."""

from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.systems.analysis import Simulator

from atlas_drake import Scenario
from atlas_drake.diagrams.atlas_station import make_atlas_station, reset_station
from atlas_drake.frozen import NOTHING
from atlas_drake.messages import Behavior


def test_a_fall_is_detected_once_is_in_a_clone_and_ends_with_a_reset(robot):
    station = make_atlas_station(robot, Scenario(initial_behavior="USER"))
    simulator = Simulator(station)
    root = simulator.get_mutable_context()
    plant = station.GetSubsystemByName("plant")
    fall = station.GetOutputPort("fall")
    simulator.AdvanceTo(0.01)
    assert fall.Eval(root) is NOTHING
    tilted = RigidTransform(RollPitchYaw(0.0, 1.05, 0.0), [0.0, 0.0, 2.0])
    plant.SetFloatingBaseBodyPoseInWorldFrame(
        plant.GetMyMutableContextFromRoot(root), plant.GetBodyByName("pelvis"), tilted
    )
    simulator.AdvanceTo(0.04)
    first = fall.Eval(root)
    assert first.time == 2 * Scenario().resolved().on_time_grid().control_period
    assert first.sign == "pelvis tilted by 1.05 rad"
    simulator.AdvanceTo(0.08)
    assert fall.Eval(root) is fall.Eval(root.Clone()) is first
    reset_station(station, root, Behavior.USER)
    assert fall.Eval(root) is NOTHING
