"""The user's own behaviors, registered beside the shipped ones."""

import copy
import pickle
import runpy
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    ErrorCode,
    InvalidMessageError,
    Scenario,
    ScenarioError,
    read_log,
)
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.idle import Idle
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.walk import Walk
from atlas_drake.config import Share, as_plain
from atlas_drake.control.whole_body import PositionTask
from atlas_drake.diagrams.atlas_station import (
    make_atlas_station,
    make_whole_body_controller,
)
from atlas_drake.messages.behavior_catalog import BehaviorError
from atlas_drake.parts.step.config import StepConfig
from atlas_drake.robot import MODELS_FOLDER
from atlas_drake.scenario import with_settings
from atlas_drake.shipped import shipped_entry
from atlas_drake.units import Meters

EXAMPLE = Path(__file__).parents[2] / "examples" / "extending" / "own_behavior.py"

HERON = str(Path(__file__).parents[1] / "robots" / "heron" / "heron.yaml")
LARGE = StepConfig(limits=replace(StepConfig().limits, rise=0.4))


@pytest.fixture(scope="module")
def example():
    return runpy.run_path(str(EXAMPLE))


@pytest.fixture(scope="module")
def bow(example):
    return example["BOW"]


@pytest.fixture(scope="module")
def adaptable(bow):
    """A simulation with BOW, and a dict of what BOW does otherwise."""
    changes = {}

    class Adaptable(Idle):
        def update(self, *arguments, **keywords):
            outcome = super().update(*arguments, **keywords)
            return changes["update"](outcome) if "update" in changes else outcome

    def condition(asked):
        return changes.get("condition", "")

    entry = replace(
        bow, make=lambda _tools, _config: Adaptable(), conditions=(condition,)
    )
    return AtlasSimulation(behaviors=[entry]), changes


@pytest.fixture
def changed(adaptable):
    """A new run of it, in which BOW does nothing unusual yet."""
    sim, changes = adaptable
    changes.clear()
    sim.reset(seed=0)
    return sim, changes


@pytest.fixture
def sim(changed):
    return changed[0]


def asked(behavior, params=None):
    command = AtlasSimInterfaceCommand(behavior=behavior)
    command.params = params
    return command


@pytest.mark.slow
def test_a_behavior_is_asked_for_by_name_runs_and_ends(example, bow, tmp_path):
    path = tmp_path / "run.mcap"
    back = None
    with AtlasSimulation(behaviors=[bow], log=path) as sim:
        back = sim.robot.joint_names.index("back_bky")
        upright = sim.atlas_state.position[back]
        sim.publish(asked("bow", example["BowParams"](depth=0.3)))
        sim.advance(2.0)
        assert sim.current_behavior == 100
        assert sim.current_behavior.name == "BOW"
        assert sim.atlas_sim_interface_state.current_behavior is sim.current_behavior
        assert sim.atlas_state.position[back] - upright > 0.15
        sim.publish(asked("STAND"))
        sim.wait_until(lambda sim: sim.current_behavior is Behavior.STAND)
        assert not sim.has_fallen
        assert [e.text for e in sim.events] == ["STAND -> BOW", "BOW -> STAND"]
        assert sim.summary()["final_behavior"] == "STAND"
    log = read_log(path)
    row = len(log) // 2
    assert log.behavior(int(log["behavior.current"][row])).name == "BOW"
    assert log.commands[0].message.params == {"depth": 0.3}
    assert log.header.catalog.find("BOW") == 100
    assert log.header.catalog.entry(log.behavior(100)).color == bow.color


@pytest.mark.parametrize(
    ("params", "words"),
    [
        ({"depth": 2.0}, r"params\.depth: must be at most 0\.6, is 2\.0"),
        ({"depth": "deep"}, r"params\.depth"),
        ({"depth": float("nan")}, r"params\.depth"),
    ],
)
def test_the_behaviors_own_check_refuses(example, sim, params, words):
    with pytest.raises(InvalidMessageError, match=words):
        sim.publish(asked("BOW", example["BowParams"](**params)))
    sim.advance(0.02)
    assert sim.current_behavior is Behavior.STAND
    sim.publish(asked("BOW"))
    sim.advance(0.02)
    assert sim.current_behavior.name == "BOW"


def test_parameters_of_another_kind_are_refused(bow, sim):
    with pytest.raises(InvalidMessageError, match="BowParams"):
        sim.publish(asked("BOW", {"depth": 0.1}))
    with pytest.raises(InvalidMessageError, match="params"):
        sim.publish(asked("WALK", bow.params()))
    with pytest.raises(InvalidMessageError, match="params"):
        sim.publish(asked("USER", bow.params()))


def test_an_exception_in_a_check_is_a_refusal(bow):
    def broken(params, field):
        raise ZeroDivisionError("oh")

    sim = AtlasSimulation(behaviors=[replace(bow, check=broken)])
    with pytest.raises(InvalidMessageError, match="check of BOW failed with ZeroDiv"):
        sim.publish(asked("BOW", bow.params()))
    sim.advance(0.02)


def test_a_behavior_begins_only_if_its_conditions_are_met(changed):
    sim, changes = changed
    changes["condition"] = "the audience is missing"
    sim.publish(asked("BOW"))
    sim.advance(0.02)
    assert sim.current_behavior is Behavior.STAND
    report = sim.atlas_sim_interface_state
    assert report.error_code is ErrorCode.FAILED_TO_START_BEHAVIOR
    assert "the audience is missing" in sim.events[-1].text


def test_a_behavior_follows_only_those_that_its_entry_names(sim):
    sim.publish(asked("MANIPULATE"))
    sim.advance(0.02)
    sim.publish(asked("BOW"))
    sim.advance(0.02)
    assert sim.current_behavior is Behavior.MANIPULATE
    assert "MANIPULATE -> BOW refused" in sim.events[-1].text


def test_a_controller_refuses_a_behavior_that_it_lacks(bow):
    sim = AtlasSimulation(
        Scenario(), controller=make_whole_body_controller, behaviors=[bow]
    )
    sim.publish(asked("BOW"))
    sim.advance(0.04)
    assert sim.current_behavior is Behavior.STAND
    assert "BOW refused: the controller has no such behavior" in sim.events[-1].text
    code = sim.atlas_sim_interface_state.error_code
    assert code is ErrorCode.BEHAVIOR_NOT_IMPLEMENTED


def test_an_unsolvable_task_is_one_warning_that_names_the_task(bow):
    task = PositionTask("l_hand", np.full(3, np.nan), 1.0)

    class WithTask(Walk):
        def __init__(self, tools, _config):
            super().__init__(tools, WalkConfig())

        def update(self, *arguments, **leaving):
            outcome = super().update(*arguments, **leaving)
            return replace(outcome, command=outcome.command.plus(task))

    sim = AtlasSimulation(behaviors=[replace(bow, make=WithTask)])
    sim.publish(asked("BOW"))
    sim.advance(0.3)
    texts = [event.text for event in sim.events if event.kind == "warning"]
    assert len(texts) == 1
    assert "found no solution" in texts[0]
    assert "(target of PositionTask on 'l_hand' is not finite)" in texts[0]
    assert sim.summary()["unsolved_ticks"] > 30


def test_no_run_begins_with_a_users_behavior(sim):
    with pytest.raises(InvalidMessageError, match="'BOW'; must be one of STAND"):
        sim.reset("BOW")


def test_a_behavior_that_is_not_registered_is_unknown(sim):
    with pytest.raises(InvalidMessageError, match="no behavior 'BOW'"):
        AtlasSimulation().publish(asked("BOW"))
    with pytest.raises(InvalidMessageError, match=r"Did you mean 'BOW'.*BOW \(100\)"):
        sim.publish(asked("BOWW"))


@dataclass(frozen=True)
class RestConfig:
    depth: Share = 0.1
    name: str = "rest"


def resting(told):
    """A behavior that notes the configuration with which it is made."""
    return BehaviorEntry(
        name="REST",
        number=101,
        make=lambda _tools, config: told.append(config) or Idle(),
        config=RestConfig(),
    )


def test_the_behaviors_configuration_comes_from_the_scenario():
    told = []
    entry = resting(told)
    scenario = with_settings(Scenario(), ["controller.rest.depth=0.4"])
    AtlasSimulation(scenario, behaviors=[entry])
    assert told == [RestConfig(depth=0.4)]
    for setting, words in (
        ("rest.depth=2", "less than or equal to 1"),
        ("rest.deph=0.2", "Did you mean 'depth'"),
        ("rst.depth=0.2", "Did you mean 'rest'"),
        ("REST.depth=0.2", "no such field"),
        ("gians.dcm_gain=2", "Did you mean 'gains'"),
    ):
        scenario = with_settings(Scenario(), [f"controller.{setting}"])
        with pytest.raises(ScenarioError, match=words) as raised:
            AtlasSimulation(scenario, behaviors=[entry])
        assert raised.value.field.startswith("controller." + setting.split(".")[0])
    with pytest.raises(ScenarioError, match="no such field"):
        AtlasSimulation(with_settings(Scenario(), ["controller.rest.depth=0.4"]))
    with pytest.raises(ScenarioError, match="there is no such field"):
        with_settings(Scenario(), ["controller.rest=0.4"])


def test_its_configuration_is_where_those_of_shipped_behaviors_are(tmp_path):
    told = []
    entry = resting(told)
    file = tmp_path / "short.yaml"
    text = (MODELS_FOLDER / "atlas.yaml").read_text()
    text = text.replace("urdf: ", f"urdf: {MODELS_FOLDER}/")
    rest = "controller:\n  rest: {depth: 0.3, name: short}\n"
    file.write_text(text.replace("controller:\n", rest))
    scenario = Scenario(model=str(file), controller={"rest": {"depth": 0.5}})
    sim = AtlasSimulation(scenario, behaviors=[entry])
    assert told == [RestConfig(depth=0.5, name="short")]
    # A log has every value.
    written = as_plain(sim.scenario)["controller"]
    assert written["rest"] == {"depth": 0.5, "name": "short"}
    assert written["walk"]["limits"]["forward"] == 0.65
    make_atlas_station(sim.robot, behaviors=[entry])
    assert told[1:] == [RestConfig(depth=0.3, name="short")]


def test_a_composed_stand_has_the_parameters_of_stand(bow):
    told = []
    entry = replace(bow, make=lambda tools, _: told.append(tools) or tools.stand())
    scenario = with_settings(Scenario(), ["controller.stand.com_speed=0.07"])
    AtlasSimulation(scenario, behaviors=[entry])
    assert told[0].stand_config.com_speed == 0.07


@dataclass(frozen=True)
class OpenConfig:
    place: Meters | None = None


def test_a_configuration_keeps_its_values_on_a_robot_of_another_size():
    told = []
    entry = replace(resting(told), config=OpenConfig(0.4))
    config = Scenario(model=HERON).controller_config([entry])
    assert config.rest == OpenConfig(0.4)
    assert pickle.loads(pickle.dumps(config)) == copy.deepcopy(config) == config


def test_a_shipped_behavior_keeps_its_configuration():
    """Beside a behavior of one's own that shares the field."""
    shipped = shipped_entry(Behavior.STEP)
    own = replace(shipped, name="STRIDE", number=103, config=LARGE, follows=("STAND",))
    config = Scenario().controller_config([replace(own, config_field="step")])
    assert config.step == Scenario().controller_config().step != LARGE


def test_two_behaviors_can_share_a_configuration():
    told = []
    march = replace(
        shipped_entry(Behavior.WALK),
        name="MARCH",
        number=102,
        make=lambda _tools, config: told.append(config) or Idle(),
        config_field="walk",
        follows=("STAND",),
    )
    scenario = with_settings(Scenario(), ["controller.walk.swing.height=0.13"])
    AtlasSimulation(scenario, behaviors=[march])
    assert told[0].swing.height == 0.13
    AtlasSimulation(scenario, behaviors=[replace(march, config_field="")])
    assert told[1].swing.height == WalkConfig().swing.height


def test_a_users_behavior_is_one_object_and_no_member_of_the_enum():
    bow = Behavior.named(100, "BOW")
    for twin in (copy.deepcopy(bow), pickle.loads(pickle.dumps(bow)), Behavior(bow)):
        assert twin is bow
        assert twin == 100
        assert (twin.name, twin.value, str(twin), hash(twin)) == (
            "BOW",
            100,
            "BOW",
            hash(bow),
        )
    assert bow not in list(Behavior)
    assert pickle.loads(pickle.dumps(Behavior.WALK)) is Behavior.WALK
    assert Behavior.named(4, "WALK") is Behavior.WALK


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"name": "rest"}, "name"),
        ({"number": 8}, "number"),
        ({"name": "WALK"}, "WALK"),
        ({"number": 100}, r"BOW \(100\) is registered already"),
        ({"color": "red"}, "color"),
        ({"params": 3}, "params"),
        ({"leads_to": ("STNAD",)}, "leads_to.*STAND"),
        ({"config": RestConfig}, "config"),
        ({"config": RestConfig(), "config_field": "walk"}, "config_field|'walk'"),
        ({"params_field": "walk_params"}, "params_field|walk_params|parameters"),
    ],
)
def test_an_entry_with_a_field_that_cannot_be_used_is_refused(bow, changes, words):
    entry = replace(bow, **({"name": "REST", "number": 101} | changes))
    with pytest.raises(BehaviorError, match=words):
        AtlasSimulation(behaviors=[bow, entry])


@pytest.mark.parametrize("behaviors", [None, [42], [BehaviorEntry]])
def test_behaviors_must_be_entries(behaviors):
    with pytest.raises(BehaviorError, match="behaviors must be"):
        AtlasSimulation(behaviors=behaviors)


def test_an_error_in_a_behavior_has_its_name(bow, changed):
    sim, changes = changed
    changes["update"] = lambda outcome: None
    sim.publish(asked("BOW"))
    with pytest.raises(AttributeError) as raised:
        sim.advance(0.02)
    assert raised.value.__notes__ == ["in the behavior BOW"]
    with pytest.raises(TypeError) as raised:
        AtlasSimulation(behaviors=[replace(bow, make=None)])
    assert raised.value.__notes__ == ["as the behavior BOW is made"]
