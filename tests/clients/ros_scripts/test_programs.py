"""Programs on the robot: time, topics, callbacks, and what goes wrong."""

import threading
from dataclasses import replace

import pytest

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.messages import Behavior

from .conftest import STEPS

HEAD = """\
#!/usr/bin/env python
from __future__ import print_function
import roslib
roslib.load_manifest("test")
import rospy, time, threading
from atlas_msgs.msg import *
from osrf_msgs.msg import JointCommands
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState
from std_msgs.msg import String
"""


@pytest.fixture
def run(run):
    """Runs a program that begins with HEAD."""
    return lambda text, *arguments, **options: run(HEAD + text, *arguments, **options)


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("time.sleep(0.04)", 0.04),
        ("rospy.sleep(rospy.Duration(0.04))", 0.04),
        ("rospy.sleep(-1.0)", 0.0),
        ("t = time.time()\nwhile time.time() - t < 0.04: pass", 0.04),
        ("while rospy.Time.now() < rospy.Time(0.04): pass", 0.04),
        ("rate = rospy.Rate(100)\nfor i in range(4): rate.sleep()", 0.04),
        (
            "rate = rospy.Rate(100)\nrospy.sleep(0.015)\nrate.sleep()\nrate.sleep()",
            0.02,
        ),
        ("for i in range(10): print(rospy.Time.now(), rospy.is_shutdown())", 0.0),
        ("m = rospy.wait_for_message('/clock', Clock)\nassert m.clock", 0.004),
        ("rospy.init_node('test')", 0.004),
    ],
)
def test_waiting_calls_advance_simulated_time(run, text, seconds):
    ran = run(text)
    assert ran.problem is None, ran.complained
    assert ran.sim.time == pytest.approx(seconds, abs=0.005)


def test_callbacks_come_while_the_program_waits(run):
    ran = run("""
got = {}
def keep(message, name):
    got.setdefault(name, []).append(message)
names = {"atlas/imu": Imu, "atlas/atlas_state": AtlasState, "/clock": Clock,
    "/atlas/atlas_sim_interface_state": AtlasSimInterfaceState,
    "joint_states": JointState, "/atlas/joint_states": JointState}
subscribers = [rospy.Subscriber(n, t, keep, n) for n, t in names.items()]
assert not got
time.sleep(0.04)
for name in names:
    assert 9 <= len(got[name]) <= 11, (name, len(got[name]))
    assert name == "/clock" or got[name][-1].header.stamp.to_sec() > 0.03
assert got["joint_states"][-1].name[AtlasState.neck_ry] == "neck_ry"
assert len(got["atlas/atlas_state"][-1].position) == 28
state = got["/atlas/atlas_sim_interface_state"][-1]
assert state.current_behavior == AtlasSimInterfaceState.STAND
assert 0.7 < state.pos_est.position.z < 1.0
assert list(bytearray(state.k_effort)) == [0] * 28
for subscriber in subscribers:
    subscriber.unregister()
time.sleep(0.04)
print(len(got["/clock"]) < 12)
""")
    assert ran.problem is None, ran.complained
    assert ran.printed == ["True"]


def test_a_callback_may_wait_and_others_go_on(run):
    ran = run("""
slow, quick = [], []
def wait(message):
    slow.append(1)
    rospy.sleep(0.03)
rospy.Subscriber("/clock", Clock, wait)
rospy.Subscriber("/clock", Clock, quick.append)
rospy.sleep(0.101)
print(len(slow), len(quick))
""")
    assert ran.printed == ["3 25"], ran.complained


def test_threads_of_the_program_take_turns_and_wait_side_by_side(run):
    ran = run("""
seen = []
def work(period):
    for i in range(3):
        before = time.time()
        sum(range(100000))
        assert time.time() == before  # Time stands still while a thread computes.
        time.sleep(period)
        seen.append((round(time.time(), 3), period))
threads = [threading.Thread(target=work, args=(p,)) for p in (0.012, 0.02)]
for thread in threads: thread.start()
threads[0].join()
print(seen, [thread.is_alive() for thread in threads])
threads[1].join(0.001)
print(len(seen), threads[1].is_alive())
threads[1].join()
print(0.06 <= time.time() < 0.065, len(seen))
""")
    first = "[(0.012, 0.012), (0.02, 0.02), (0.024, 0.012), (0.036, 0.012)]"
    printed = [f"{first} [False, True]", "4 True", "True 6"]
    assert ran.printed == printed, ran.complained


def test_the_main_thread_simulates(run, sim):
    # Meshcat can be used from the thread alone that began it.
    threads = []
    sim.hooks.append(lambda _sim: threads.append(threading.current_thread()))
    run("""
rospy.Subscriber("/clock", Clock, lambda message: rospy.sleep(0.002))
threading.Thread(target=lambda: time.sleep(0.02)).start()
time.sleep(0.01)
""")
    sim.hooks.clear()
    assert set(threads) == {threading.main_thread()}


def test_two_runs_with_threads_are_the_same(run, sim):
    text = """
elbow = rospy.Publisher("/atlas/joint_commands", JointCommands)
def wave():
    rate = rospy.Rate(90)
    while not rospy.is_shutdown():
        elbow.publish(name=["l_arm_elx"], position=[1.0 + rospy.get_time()])
        sum(range(3000))
        rate.sleep()
threading.Thread(target=wave).start()
states = []
rospy.Subscriber("/atlas/atlas_state", AtlasState, states.append)
for i in range(10): time.sleep(0.007)
rospy.signal_shutdown("done")
print(len(states), states[-1].position[AtlasState.l_arm_elx])
"""
    first = run(text)
    assert len(first.printed) == 1, first.complained
    state = first.sim.atlas_state
    sim.reset(seed=0)
    second = run(text)
    assert second.printed == first.printed
    assert second.sim.atlas_state == state


@pytest.mark.parametrize("kind", ["Lock", "RLock"])
def test_waiting_for_locks_and_events_lets_time_pass(run, kind):
    ran = run(f"""
lock, calls, heard = threading.{kind}(), [], threading.Event()
def count(message):
    heard.set()
    with lock:
        calls.append(message.clock.to_sec())
print(heard.wait(0.02), time.time())
rospy.Subscriber("/clock", Clock, count)
with lock:
    print(heard.wait(), time.time(), calls)
    rospy.sleep(0.03)
rospy.sleep(0.01)
print(calls, lock.acquire(False))
thread = threading.Thread(target=lambda: print(lock.acquire(timeout=0.02)))
thread.start()
thread.join()
lock.release()
""")
    assert ran.printed == [
        "False 0.02",
        "True 0.024 []",
        # The first call waits for the lock, asking once per control period.
        "[0.024, 0.06, 0.064] True",
        "False",
    ], ran.complained


def test_a_program_ends_with_its_last_thread(run):
    ran = run("""
def late():
    rospy.sleep(0.05)
    print("last")
def never():
    rospy.sleep(9)
    print("never")
threading.Thread(target=late).start()
helper = threading.Thread(target=never)
helper.daemon = True
helper.start()
print("first")
""")
    assert ran.problem is None, ran.complained
    assert ran.printed == ["first", "last"]
    assert ran.sim.time == pytest.approx(0.05, abs=0.004)


def test_threads_end_with_the_run(run):
    ran = run(
        """
def work():
    while not rospy.is_shutdown():
        time.sleep(0.01)
workers = [threading.Thread(target=f) for f in (work, threading.Event().wait)]
for worker in workers: worker.start()
rospy.spin()
print([worker.is_alive() for worker in workers])
""",
        end=0.03,
    )
    assert ran.problem is None, ran.complained
    assert ran.printed == ["[False, False]"]
    assert ran.sim.time == pytest.approx(0.03)


@pytest.mark.parametrize(("text", "at_fault"), [("[][0]", False), ("rospy.F", True)])
def test_an_error_in_a_callback_ends_the_program(run, text, at_fault):
    ran = run(f"""
rospy.Subscriber("/clock", Clock, lambda message: {text})
rospy.spin()
print("shut down")
""")
    assert ran.printed == ["shut down"]
    assert "program.py" in ran.complained
    assert ran.at_fault is at_fault
    assert ran.sim.time == pytest.approx(0.004)


def test_parameters_are_a_tree(run):
    ran = run("""
rospy.init_node("node")
rospy.set_param("/ns", {"x": 1, "y": {"z": 2}})
rospy.set_param("ns/w", 3)
rospy.set_param("~own", 4)
print(rospy.get_param("ns/x"), rospy.get_param("/ns/y/z"), rospy.get_param("/ns"))
print(rospy.get_param("/node/own"), rospy.has_param("/own"), rospy.has_param("~own"))
rospy.get_param("/ns")["x"] = 9
print(rospy.get_param("ns/x"))
gains = rospy.get_param("atlas_controller/gains/atlas::l_arm_uwy")
print(gains == rospy.get_param("atlas_controller/gains")["l_arm_uwy"], sorted(gains))
rospy.get_param("/ns/v")
""")
    assert ran.printed == [
        "1 2 {'x': 1, 'y': {'z': 2}, 'w': 3}",
        "4 False True",
        "1",
        "True ['d', 'i', 'i_clamp', 'p']",
    ]
    assert "parameter '/ns/v'" in ran.complained


def test_commands_reach_the_robot(run):
    ran = run("""
command = rospy.Publisher("atlas/atlas_command", AtlasCommand, queue_size=1)
message = AtlasCommand()
message.header.stamp = rospy.Time.now()
message.position = [0.0] * 28
message.position[AtlasState.neck_ry] = 0.3
message.k_effort = [0] * 28
message.k_effort[AtlasState.neck_ry] = 255
command.publish(message)
joints = rospy.Publisher("/atlas/joint_commands", JointCommands)
gain = rospy.get_param("atlas_controller/gains/l_arm_uwy/p")
joints.publish(name=["atlas::l_arm_uwy", "r_arm_wry"], position=[0.2, 0.1],
               kp_position=[gain, gain])
rospy.sleep(0.01)
state = rospy.wait_for_message("/atlas/atlas_state", AtlasState)
print([i for i, k in enumerate(bytearray(state.k_effort)) if k == 255])
mode = rospy.Publisher("/atlas/control_mode", String, None, False, True, None)
mode.publish("Manip")
rospy.sleep(0.02)
""")
    assert ran.problem is None, ran.complained
    # Besides the neck only the two joints that joint_commands names.
    assert ran.printed == ["[3, 20, 26]"]
    in_force = ran.sim.output("commands").joints
    assert in_force.position[[3, 20, 26]].tolist() == [0.3, 0.2, 0.1]
    assert in_force.kp_position[26] == in_force.kp_position[20] == 50.0
    assert ran.sim.current_behavior is Behavior.MANIPULATE
    # The word gives the behavior all joints.
    assert set(ran.sim.atlas_state.k_effort) == {0}


@pytest.mark.parametrize(
    ("word", "behavior"),
    [
        ("User", Behavior.USER),
        ("walk", Behavior.WALK),
        ("STEP", Behavior.STEP),
        ("stand_prep", Behavior.STAND_PREP),
    ],
)
def test_control_modes_are_behaviors(run, word, behavior):
    text = f"rospy.Publisher('atlas/control_mode', String).publish({word!r})\n"
    ran = run(text + "rospy.sleep(0.01)\n")
    assert ran.sim.current_behavior is behavior, ran.complained
    assert set(ran.sim.atlas_state.k_effort) == {255 if word == "User" else 0}


def test_the_mode_nominal_releases_the_gantry(run):
    scenario = Scenario(initial_behavior="FREEZE", **STEPS)
    start = replace(scenario.start, on_gantry=True)
    scenario = replace(scenario, start=start)
    ran = run(
        """
mode = rospy.Publisher("/atlas/mode", String)
rospy.sleep(0.01)
mode.publish("harnessed")
rospy.sleep(0.01)
mode.publish("nominal")
rospy.sleep(0.01)
""",
        on=AtlasSimulation(scenario),
    )
    assert ran.problem is None, ran.complained
    assert [event.kind for event in ran.sim.events][-2:] == ["reset", "gantry"]


def test_commands_without_effect_are_noted_once_and_the_program_continues(run):
    ran = run("""
command = rospy.Publisher("atlas/atlas_command", AtlasCommand)
for i in range(2):
    command.publish(AtlasCommand(position=[0.0] * 28))
rospy.Publisher("/atlas/mode", String).publish("harnessed")
command.publish(AtlasCommand(position=[0.0] * 27, k_effort=[255] * 28))
print("on")
""")
    assert ran.printed == ["on"]
    assert ["initial_behavior=USER" in said for said in ran.said] == [True, False]
    assert "start.on_gantry=true" in ran.said[1]
    refusals = [event.text for event in ran.sim.events if event.kind == "refusal"]
    assert "position" in refusals[0]
    assert set(ran.sim.atlas_state.k_effort) == {0}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("rospy.Pubisher", ["rospy.Pubisher", "Did you mean 'Publisher'"]),
        ("from rospy import Foo", ["'Foo'", "rospy"]),
        ("threading.Condition()", ["threading.Condition", "Event, Lock, RLock"]),
        ("import queue", ["module queue", "threading"]),
        ("import foo_msgs.msg", ["foo_msgs"]),
        ("rospy.Publisher('/atlas/mode', Imu)", ["std_msgs/String", "sensor_msgs/Imu"]),
        ("AtlasCommand().foo = 1", ["field foo of atlas_msgs/AtlasCommand"]),
        ("rospy.get_param('foo')", ["parameter 'foo'"]),
        (
            "rospy.Publisher('/atlas/control_mode', String).publish('Dance')",
            ["'Dance'", "Stand"],
        ),
        (
            "rospy.Publisher('/atlas/joint_commands', JointCommands)"
            ".publish(name=['tail'])",
            ["name", "tail"],
        ),
        (
            "rospy.Publisher('/atlas/joint_commands', JointCommands)"
            ".publish(name=['neck_ry'], effort=[1.0, 2.0])",
            ["effort", "1 elements"],
        ),
    ],
)
def test_an_unknown_name_raises_with_the_known_names(run, text, words):
    ran = run(text + "\n")
    assert ran.at_fault
    for word in words:
        assert word in ran.complained
    # The traceback begins in the program.
    assert "program.py" in ran.complained.partition("File ")[2].partition("\n")[0]


def test_a_program_has_arguments_and_defaults_of_unknown_names(run):
    text = "import sys\nprint(sys.argv[1:], rospy.myargv()[1:])\n"
    text += "print(hasattr(rospy, 'Foo'), getattr(rospy, 'Foo', 3))\n"
    text += "print(rospy.get_param('~foo', 4), rospy.has_param('foo'))\n"
    ran = run(text, "-a", "x:=y")
    assert ran.printed == ["['-a', 'x:=y'] ['-a']", "False 3", "4 False"]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("import sys; sys.exit(0)", None),
        ("import sys; sys.exit(3)", "program.py ended with status 3"),
        ("import sys; sys.exit('no')", "program.py gave up: no"),
        ("[][0]", "program.py: IndexError: list index out of range"),
        (
            "rospy.Publisher('/atlas/mode', String).publish(Imu())",
            "program.py: TypeError: /atlas/mode has messages std_msgs/String, not "
            "sensor_msgs/Imu",
        ),
    ],
)
def test_the_end_of_a_program_is_reported(run, text, problem):
    ran = run(text)
    assert ran.problem == problem
    assert not ran.at_fault


def test_at_the_end_of_the_run_a_program_is_shut_down(run):
    ran = run(
        """
rospy.on_shutdown(lambda: print("bye"))
rospy.spin()
print(rospy.is_shutdown(), rospy.get_time())
try:
    rospy.sleep(1.0)
except rospy.ROSInterruptException:
    print("interrupted")
try:
    time.sleep(1.0)
except Exception:
    print("never")
""",
        end=0.1,
    )
    assert ran.problem is None
    assert ran.printed == ["True 0.1", "interrupted", "bye"]
    assert ran.sim.time == pytest.approx(0.1)


def test_steps_are_made_with_pykdl_and_posemath(run):
    ran = run("""
import PyKDL
from tf_conversions import posemath
walk = AtlasSimInterfaceCommand(behavior=AtlasSimInterfaceCommand.WALK)
q = rospy.wait_for_message("/atlas/imu", Imu).orientation
robot = PyKDL.Frame(PyKDL.Rotation.Quaternion(q.x, q.y, q.z, q.w), PyKDL.Vector())
for i in range(4):
    step = AtlasBehaviorStepData(step_index=i + 1, foot_index=i % 2, duration=0.63)
    # Both feet of a pair go as far: in Python 2 these are whole numbers.
    ahead = PyKDL.Vector((1 + i / 2) * 0.2, 0.12 - i % 2 * 0.24, 0.0)
    step.pose = posemath.toMsg(robot * PyKDL.Frame(ahead))
    walk.walk_params.step_queue[i] = step
walk.k_effort = "".join(chr(0) for _ in range(28))
rospy.Publisher("/atlas/atlas_sim_interface_command", type(walk)).publish(walk)
rospy.sleep(0.02)
""")
    assert ran.problem is None, ran.complained
    assert ran.sim.current_behavior is Behavior.WALK
    queue = ran.sim.output("commands").request.command.walk_params.step_queue
    x = [step.pose.position.x for step in queue]
    assert x == pytest.approx([0.2, 0.2, 0.4, 0.4], abs=0.01)
