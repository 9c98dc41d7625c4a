"""The socket for the user's own controller."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import LeafSystem

from atlas_drake import (
    AtlasBehaviorWalkFeedback,
    AtlasCommand,
    AtlasSimulation,
    Behavior,
    Scenario,
    read_log,
)
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.diagrams.atlas_station import make_atlas_station
from atlas_drake.diagrams.controller_socket import ControllerError
from atlas_drake.frozen import NOTHING
from atlas_drake.messages.controller_status import (
    ControllerStatus,
    Plan,
    PlannedPaths,
)
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import Footstep
from atlas_drake.scenario import with_settings
from atlas_drake.simulation import SimulationError

EXAMPLE = Path(__file__).parents[2] / "examples" / "extending" / "own_controller.py"
SQUARE = np.array([[0.1, 0.1], [-0.1, 0.1], [-0.1, -0.1], [0.1, -0.1]])
EVENT = Event(0.0, "x", "y")
PATHS = PlannedPaths(com=np.array([[0.0, 0.0], [0.3, 0.1]]))


@pytest.fixture(scope="module")
def gravity_pd():
    return runpy.run_path(str(EXAMPLE))["GravityCompensatedPd"]


def zero(_context, out):
    out.SetZero()


def sized(size, name="behavior_effort", calc=zero):
    """A System with one output port."""
    system = LeafSystem()
    system.DeclareVectorOutputPort(name, size, calc)
    return system


def controller_with_status(robot, status, calc=zero, port="controller_status"):
    """A controller whose status is what a callable gives of the Context."""
    system = sized(robot.num_joints, calc=calc)
    system.DeclareAbstractOutputPort(
        port,
        lambda: AbstractValue.Make(NOTHING),
        lambda context, out: out.set_value(status(context)),
    )
    return system


class Talkative(LeafSystem):
    """Gives no effort, and tells much of itself."""

    def __init__(self, robot, scenario):
        super().__init__()
        self.tick_seconds = []
        self.resets = []
        self._period = scenario.control_period
        self._ticks = self.DeclareDiscreteState(1)
        self.DeclarePeriodicDiscreteUpdateEvent(
            scenario.control_period, 0.0, self._tick
        )
        self.DeclareVectorOutputPort("behavior_effort", robot.num_joints, zero)
        self.DeclareAbstractOutputPort(
            "controller_status",
            lambda: AbstractValue.Make(ControllerStatus()),
            self._tell,
        )
        self.DeclareAbstractOutputPort(
            "planned_paths",
            lambda: AbstractValue.Make(PlannedPaths()),
            lambda _context, out: out.set_value(PATHS),
        )

    def reset(self, context, behavior):
        self.resets.append(behavior)

    def _tick(self, context, discrete):
        discrete.set_value(context.get_discrete_state_vector().value() + 1)
        self.tick_seconds.append(0.001)

    def _tell(self, context, out):
        ticks = int(context.get_discrete_state_vector().value()[0])
        out.set_value(
            ControllerStatus(
                current_behavior=Behavior.FREEZE,
                feedback=AtlasBehaviorWalkFeedback(current_step_index=7),
                events=(Event(0.0, "warning", "hello"),),
                event_count=1,
                solved=True,
                unsolved=ticks,
                plan=Plan(
                    support=SQUARE.tolist(),  # Lists of points count as arrays.
                    footsteps=(Footstep(1, 0, np.array([0.3, 0.1, 0.0]), 0.2),),
                ),
            )
        )


class WithoutReset(Talkative):
    """Has no method `reset`."""

    def __getattribute__(self, name):
        if name == "reset":
            raise AttributeError(name)
        return super().__getattribute__(name)


class Counting(WithoutReset):
    """Tells an event in each tick, and two from the start."""

    def _tell(self, context, out):
        count = 2 + int(context.get_discrete_state_vector().value()[0])
        events = tuple(Event(0.0, "note", f"{i}") for i in range(count))
        out.set_value(ControllerStatus(events=events, event_count=count))


@pytest.mark.slow
def test_a_controller_without_status_holds_the_robot(gravity_pd, tmp_path):
    path = tmp_path / "run.mcap"
    with AtlasSimulation(controller=gravity_pd, log=path) as sim:
        sim.advance(1.0)
        effort = sim.output("behavior_effort")
        report = sim.atlas_sim_interface_state
        assert not sim.has_fallen
        assert sim.pelvis_pose.translation()[2] > 0.8
        assert report.current_behavior is Behavior.NONE
        np.testing.assert_array_equal(report.f_out, effort)
        assert np.linalg.norm(report.foot_pos_est[0].position.to_array()) > 0.05
        assert len(sim.tick_seconds) == 0
        assert sim.summary()["controller_tick_ms"]["median"] is None
    log = read_log(path)
    assert np.abs(log["joints.behavior_effort"][-1]).max() > 10.0
    assert (log["controller.solved"] == -1).all()
    assert np.isnan(log["balance.dcm_reference"]).all()
    assert np.isfinite(log["balance.dcm"]).all()


def test_efforts_of_a_foreign_controller_are_blended(gravity_pd):
    sim = AtlasSimulation(controller=gravity_pd)
    command = AtlasCommand()
    command.position = sim.robot.stand_prep
    command.kp_position = sim.robot.default_kp
    command.kd_position = sim.robot.default_kd
    command.k_effort = [51] * sim.robot.num_joints
    sim.publish(command)
    sim.advance(0.1)
    blend = 0.2 * sim.output("user_effort") + 0.8 * sim.output("behavior_effort")
    np.testing.assert_allclose(sim.output("effort"), blend, atol=1e-9)


def test_a_behavior_in_the_status_must_be_registered(tmp_path):
    hold = BehaviorEntry(name="HOLD", number=200, make=lambda _tools, _config: None)

    class Named(Talkative):
        def _tell(self, context, out):
            out.set_value(ControllerStatus(current_behavior=hold.behavior))

    with pytest.raises(ValueError, match=r"HOLD \(200\), which is not registered"):
        AtlasSimulation(controller=Named).advance(0.02)
    path = tmp_path / "run.mcap"
    with AtlasSimulation(controller=Named, behaviors=[hold], log=path) as sim:
        sim.advance(0.02)
        assert sim.current_behavior is hold.behavior
    log = read_log(path)
    assert log.behavior(int(log["behavior.current"][-1])) is hold.behavior


def test_a_fall_under_a_foreign_controller_goes_by_the_scenarios_limits():
    def first_tilt(limit):
        scenario = with_settings(Scenario(), [f"controller.fall.tilt={limit}"])
        sim = AtlasSimulation(
            scenario, controller=lambda robot, _: sized(robot.num_joints)
        )
        sim.wait_until(lambda sim: sim.has_fallen, 3.0)
        (fall,) = sim.events
        assert fall.kind == "fall"
        assert sim.summary()["fell"]
        sim.reset()
        assert not sim.has_fallen
        assert sim.events[-1].kind == "reset"
        return fall.text

    assert first_tilt(0.2).startswith("falling (pelvis tilted by 0.2")
    assert not first_tilt(1.5).startswith("falling (pelvis tilted by 0.")


def test_the_status_of_a_controller_is_reported_and_logged(tmp_path):
    path = tmp_path / "run.mcap"
    with AtlasSimulation(controller=Talkative, log=path) as sim:
        sim.advance(0.1)
        assert sim.current_behavior is Behavior.FREEZE
        report = sim.atlas_sim_interface_state
        assert report.current_behavior is Behavior.FREEZE
        assert report.walk_feedback.current_step_index == 7
        assert report.feedback is None
        np.testing.assert_array_equal(sim.output("planned_paths").com, PATHS.com)
        assert [e.text for e in sim.events] == ["hello"]
        assert sim.summary()["controller_tick_ms"]["median"] == pytest.approx(1.0)
        sim.reset()
        assert sim.station.GetSubsystemByName("controller").resets == [Behavior.STAND]
    log = read_log(path)
    assert log["controller.unsolved"][-1] > 5
    assert log["walk.current_step_index"][-1] == 7
    assert (log["controller.solved"] == 1).all()
    np.testing.assert_allclose(log["balance.support"][-1][:8], SQUARE.ravel())
    np.testing.assert_array_equal(log.paths_at(len(log) - 1).com, PATHS.com)


@pytest.fixture(scope="module")
def shared():
    given = {"status": ControllerStatus}

    def status(_context):
        return given["status"]()

    return AtlasSimulation(
        controller=lambda robot, _: controller_with_status(robot, status)
    ), given


@pytest.fixture
def foreign(shared):
    """A new run of a foreign controller, and a dict with what makes its status."""
    sim, given = shared
    given["status"] = ControllerStatus
    sim.reset(seed=0)
    return sim, given


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (lambda: "hello", "controller_status"),
        (lambda: NOTHING, "controller_status"),
        (lambda: ControllerStatus(plan=None), "plan"),
        (lambda: ControllerStatus(current_behavior=3), "current_behavior"),
        (lambda: ControllerStatus(events=(EVENT,)), "event_count"),
        (lambda: ControllerStatus(events=("oh",), event_count=1), "events"),
        (lambda: ControllerStatus(solved="yes"), "solved"),
        (lambda: Event(np.nan, "x", "y"), "time"),
        (lambda: Event(0.0, "footstep", "y", {"foot": 0}), "commanded"),
        (lambda: Plan(support=np.zeros((9, 2))), "support"),
        (lambda: Plan(com_reference=[0.0] * 3), "com_reference"),
        (lambda: Plan(omega=-1.0), "omega"),
        (lambda: PlannedPaths(swing=["up"]), "swing"),
        (lambda: Footstep(1, 2, [0.0] * 3, 0.0), "foot"),
        (lambda: Footstep(1, 0, None, 0.0), "p_WF"),
    ],
)
def test_an_invalid_status_raises_an_error_that_names_the_field(foreign, status, words):
    sim, given = foreign
    given["status"] = status
    with pytest.raises((TypeError, ValueError), match=words):
        sim.advance(0.01)


def test_a_faulty_status_is_one_error_and_leaves_no_log(tmp_path):
    sim = AtlasSimulation(
        controller=lambda robot, _: controller_with_status(robot, lambda _: "hello"),
        log=tmp_path / "run.mcap",
    )
    with pytest.raises(TypeError) as caught, sim:
        sim.advance(0.01)
    assert caught.value.__context__ is None
    assert not any(tmp_path.iterdir())


def test_events_counted_from_zero_after_a_reset_are_all_collected():
    steps = Scenario(physics_step=0.002, control_period=0.004)  # The counts are of it.
    sim = AtlasSimulation(steps, controller=Counting)
    sim.advance(0.04)
    assert [event.text for event in sim.events] == [f"{i}" for i in range(12)]
    sim.reset()
    sim.advance(0.02)
    texts = [event.text for event in sim.events]
    assert texts[12].startswith("reset")
    assert texts[13:] == [f"{i}" for i in range(7)]


@pytest.mark.filterwarnings("ignore:invalid value")
def test_an_effort_that_is_not_finite_is_an_error():
    def broken(_context, out):
        out.SetZero()
        out.SetAtIndex(2, np.nan)

    sim = AtlasSimulation(controller=sized(28, calc=broken))
    with pytest.raises(SimulationError, match="behavior_effort of back_bkx is not fin"):
        sim.advance(0.01)


def test_a_controller_that_is_in_a_diagram_already_is_refused():
    kept = sized(28)
    make_atlas_station(controller=kept)
    with pytest.raises(ControllerError, match="in another diagram already"):
        make_atlas_station(controller=kept)
    with pytest.raises(ControllerError, match="controller must be a System"):
        make_atlas_station(controller=())


def test_planned_paths_of_another_type_are_refused():
    sim = AtlasSimulation(
        controller=lambda robot, _: controller_with_status(
            robot, lambda _context: "straight on", port="planned_paths"
        )
    )
    with pytest.raises(TypeError, match="planned_paths"):
        sim.output("planned_paths")


def test_a_controller_without_reset_gets_its_default_state():
    sim = AtlasSimulation(controller=WithoutReset)
    sim.advance(0.1)
    assert sim.output("controller_status").unsolved > 5
    sim.reset()
    assert sim.output("controller_status").unsolved < 3


def with_input(name, size):
    system = sized(28)
    system.DeclareVectorInputPort(name, size)
    return system


def with_vector_status(size):
    system = sized(28)
    system.DeclareVectorOutputPort("controller_status", size, zero)
    return system


def with_message(name):
    system = sized(28, calc=lambda context, out: (port.Eval(context), out.SetZero()))
    port = system.DeclareAbstractInputPort(name, AbstractValue.Make(NOTHING))
    return system


@pytest.mark.parametrize(
    ("controller", "words"),
    [
        (3, "controller must be a System"),
        (lambda robot, scenario: None, "None"),
        (sized(28, "torque"), "'behavior_effort'"),
        (sized(3), "'behavior_effort'.* size 28"),
        (with_vector_status(3), "controller_status"),
        (with_input("stat", 69), "'stat'.* Did you mean 'state'"),
        (with_input("state", 7), "port state of .* 7"),
        (with_input("commands", 7), "port commands"),
        (with_message("imu"), "'imu'.*periodic update"),
    ],
)
def test_a_controller_that_does_not_fit_is_refused(controller, words):
    with pytest.raises(ControllerError, match=words):
        make_atlas_station(controller=controller)
