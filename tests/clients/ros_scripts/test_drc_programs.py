"""Programs of the kinds that were written for DRCSim, each in a few lines."""

import os
import sys
from dataclasses import replace

import pytest

from atlas_drake import AtlasSimulation
from atlas_drake.clients.ros_scripts.program import unfinished
from atlas_drake.messages import Behavior

HEAD = """\
#!/usr/bin/env python
from __future__ import print_function
import actionlib, math, numpy, rospy, sys, time
from atlas_msgs.msg import *
from geometry_msgs.msg import Pose
from osrf_msgs.msg import JointCommands
from sensor_msgs.msg import Joy, JointState
from std_msgs.msg import Float64, Header, String
from std_srvs.srv import Empty
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
joints = lambda: rospy.wait_for_message("/joint_states", JointState).position
def goal(behavior, steps=None, step=AtlasBehaviorStepData()):
    return WalkDemoGoal(Header(), behavior, steps, AtlasBehaviorStepParams(step, False),
        AtlasBehaviorStandParams(), AtlasBehaviorManipulateParams(), [0] * 28)
def at(i, x, y):
    step = AtlasBehaviorStepData(step_index=i, foot_index=int(y < 0), duration=0.63)
    step.pose.position.x, step.pose.position.y, step.swing_height = x, y, 0.1
    return step
client = actionlib.SimpleActionClient("atlas/bdi_control", WalkDemoAction)
assert client.wait_for_server()
"""


@pytest.fixture(scope="module")
def shared_sim():
    return AtlasSimulation()


@pytest.fixture
def run(run):
    """Runs a program that begins with HEAD, for at most 20 simulated seconds."""
    return lambda text, **options: run(HEAD + text, **{"end": 20.0} | options)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "printed", "notes"),
    [
        pytest.param(
            """
calls = []
client.send_goal(goal(WalkDemoGoal.MANIPULATE), lambda *got: calls.append(got),
    lambda: calls.append("active"), lambda got: calls.append(got.state))
print(client.wait_for_result(rospy.Duration(1)), client.get_result().success)
rospy.sleep(0.01)
print(calls[0], calls[1].current_behavior, calls[-1][0], client.get_state())
""",
            ["True True", "active 6 3 3"],
            [],
            id="goal with callbacks",
        ),
        pytest.param(
            """
for wrong in goal(9), goal(4, [at(0, 0.1, 0.1)]), goal(4, [at(1, 0.1, 0.1)] * 2):
    client.send_goal(wrong)
    print(client.get_state() == actionlib.GoalStatus.ACTIVE)
    client.send_goal(goal(WalkDemoGoal.STAND))
client.send_goal_and_wait(goal(9), rospy.Duration(1))
print(client.get_state(), client.get_result().success)
print(client.get_goal_status_text())
client.cancel_all_goals()
print(client.send_goal_and_wait(goal(4, [at(0, 0.1, 0.1)])))
""",
            [*["True"] * 3, "4 False", "behavior must be 0 to 6, is 9", "4"],
            ["is 9", "step_index above 0"],
            id="goal that cannot be reached",
        ),
        pytest.param(
            """
def moved(message):
    arm.publish(name=["atlas::l_arm_uwy"], position=[message.axes[0]])
arm = rospy.Publisher("atlas/joint_commands", JointCommands)
rospy.Subscriber("joy", Joy, moved)
stick = rospy.Publisher("joy", Joy, latch=True)
stick.publish(Joy(axes=[0.25], buttons=[0] * 25))
rospy.sleep(0.3)
print(joints()[AtlasState.l_arm_uwy] > 0.1)
""",
            ["True"],
            ["writes topic /joy", "reads topic /joy"],
            id="Joy to joint commands",
        ),
        pytest.param(
            """
neck = rospy.Publisher("/neck_ry_position_controller/command", Float64)
rospy.Publisher("/l_f0_j0_position_controller/command", Float64).publish(1.0)
rospy.Publisher("/multisense_sl/set_spindle_speed", Float64).publish(2.0)
rospy.Publisher("/atlas/mode", String).publish("pinned_with_gravity")
rospy.Publisher("atlas/atlas_comand", AtlasCommand).publish(AtlasCommand())
neck.publish(0.2)
rospy.sleep(0.3)
print(joints()[AtlasState.neck_ry] > 0.1)
""",
            ["True"],
            [
                "l_f0_j0",
                "set_spindle_speed",
                "pinned_with_gravity",
                "Did you mean '/atlas/atlas_command'",
            ],
            id="a controller for each joint, and topics of other parts",
        ),
        pytest.param(
            """
path = JointTrajectory(joint_names=["atlas::neck_ay", "l_arm_wry"])
path.header.frame_id = "atlas::pelvis"
for i in range(10):
    point = JointTrajectoryPoint(positions=[0.03 * i, 0.0])
    point.time_from_start = rospy.Duration.from_sec(0.03)
    path.points.append(point)
rospy.Publisher("/joint_trajectory", JointTrajectory).publish(path)
rospy.sleep(0.15)
early = joints()[AtlasState.neck_ry]
rospy.sleep(0.35)
print(0.03 < early < 0.2 < joints()[AtlasState.neck_ry] < 0.3)
print(sum(bytearray(rospy.wait_for_message("/atlas/atlas_state", AtlasState).k_effort)))
""",
            ["True", "510"],
            [],
            id="joint trajectory",
        ),
        pytest.param(
            """
got = []
rospy.Subscriber("/atlas/joint_states", JointState, got.append)
command = JointCommands(name=["atlas::l_arm_mwx"], position=numpy.zeros(1))
rospy.init_node("trajectory")
pub = rospy.Publisher("/atlas/joint_commands", JointCommands, queue_size=1)
begin, n = numpy.array(got[-1].position)[21:22], math.ceil(0.1 / 0.02)
for ratio in numpy.linspace(0, 1, n):
    command.position = [float(x) for x in (1 - ratio) * begin + ratio * 0.1]
    pub.publish(command)
    rospy.sleep(0.1 / float(n))
print(command.position, n)
""",
            ["[0.1] 5.0"],
            [],
            id="interpolation with a whole float",
        ),
        pytest.param(
            """
rospy.wait_for_service("/gazebo/reset_models")
begin = joints()[20]
rospy.Publisher("/l_arm_wry_position_controller/command", Float64).publish(1.0)
rospy.sleep(0.3)
print(joints()[20] > begin + 0.3)
for name in "pause_physics", "reset_models":
    rospy.ServiceProxy("/gazebo/" + name, Empty)()
now = rospy.get_time()
time.sleep(1.0)
rospy.ServiceProxy("/gazebo/unpause_physics", Empty)()
print(rospy.get_time() == now, abs(joints()[20] - begin) < 0.01)
try:
    rospy.ServiceProxy("/atlas/set_joint_damping", Empty)([0.1] * 28)
except rospy.ServiceException, error:
    print("no stand-in for service '/atlas/set_joint_damping'" in str(error))
""",
            ["True", "True True", "True"],
            [],
            id="services",
        ),
        pytest.param(
            """
try:
    rospy.wait_for_message("/own", String, timeout=0.1)
except rospy.ROSException, error:
    print(error)
""",
            ["no message on topic /own within 0.1 s"],
            ["topic /own"],
            id="topic without messages",
        ),
    ],
)
def test_programs_of_the_time_run(run, text, printed, notes):
    ran = run(text)
    assert ran.problem is None, ran.complained
    assert ran.printed == printed, ran.said
    assert len(ran.said) == len(notes), ran.said
    for note, said in zip(notes, ran.said, strict=True):
        assert note in said
    assert unfinished(ran.sim) == []


@pytest.mark.slow
def test_goals_walk_and_step_relative_to_the_robot(run, sim):
    start = replace(sim.scenario.start, position=(1.0, 2.0), yaw=1.5)
    sim.reset(pose=start)
    ran = run("""
walk = [at(0, 0.15, 0.1), at(1, 0.2, -0.1), at(2, 0.2, 0.1)]
print(client.send_goal_and_wait(goal(WalkDemoGoal.WALK, walk)))
step = at(1, 0.1, 0.12)
step.duration = 0.0  # The original did not read it.
print(client.send_goal_and_wait(goal(WalkDemoGoal.STEP, None, step)))
print(client.send_goal_and_wait(goal(WalkDemoGoal.STAND)), client.get_result().success)
client.send_goal(goal(WalkDemoGoal.WALK, walk))
client.cancel_goal()
print(client.get_state(), client.wait_for_result(0.1))
client.send_goal(goal(WalkDemoGoal.WALK, walk))
rospy.sleep(0.1)
""")
    assert ran.problem is None, ran.complained
    assert ran.printed == ["3", "3", "3 True", "2 True"], ran.said
    landed = [step["landed"] for step in ran.sim.footsteps[:2]]
    assert [foot[1] for foot in landed] == pytest.approx([2.2, 2.2], abs=0.03)
    assert [foot[0] for foot in landed] == pytest.approx([1.1, 0.9], abs=0.03)
    assert unfinished(ran.sim) == ["2 steps", "a goal of atlas/bdi_control"]


def test_a_goal_and_a_trajectory_continue_when_their_program_has_ended(run):
    ran = run("""
client.send_goal(goal(WalkDemoGoal.MANIPULATE))
path = JointTrajectory(joint_names=["neck_ry"])
for position in 0.1, 0.2:
    path.points.append(JointTrajectoryPoint(positions=[position]))
    path.points[-1].time_from_start = rospy.Duration(0.05)
rospy.Publisher("/joint_trajectory", JointTrajectory).publish(path)
""")
    both = ["a goal of atlas/bdi_control", "a joint trajectory"]
    assert unfinished(ran.sim) == both
    ran.sim.advance(0.1)
    assert unfinished(ran.sim) == []
    assert ran.sim.current_behavior is Behavior.MANIPULATE
    assert ran.sim.output("commands").joints.position[3] == 0.2


def test_time_passes_while_a_program_waits_for_a_key(run, monkeypatch):
    read, write = os.pipe()
    with os.fdopen(read) as keys, os.fdopen(write, "w") as typist:
        monkeypatch.setattr(sys, "stdin", keys)

        def type_at_times(sim):
            for time in list(script):
                if sim.time >= time:
                    typist.write(script.pop(time))
                    typist.flush()

        script = {0.1: "w\u00e4", 0.2: "lk\nyes\n", 0.5: "q"}
        sim = run("").sim
        sim.hooks.append(type_at_times)
        ran = run(
            """
from select import select
key = [sys.stdin]
print(select(key, [], [], 0)[0], select(key, [], [], 0.05)[0])
print(sys.stdin.read(1), 0.1 <= time.time() < 0.15)
print(select(key, [], [], 0)[0] == key, sys.stdin.readline())
print(raw_input("sure? "), 0.2 <= time.time() < 0.25)
print(sys.stdin.read(1), 0.5 <= time.time() < 0.55)
try:
    sys.stdin.read()
except KeyboardInterrupt:
    print(rospy.is_shutdown())
""",
            end=0.6,
        )
    assert ran.problem is None, ran.complained
    assert ran.printed == [
        "[] []",
        "w True",
        "True \u00e4lk",
        "",
        "sure? yes True",
        "q True",
        "True",
    ]
    assert ran.sim.current_behavior is Behavior.STAND
