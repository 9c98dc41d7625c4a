"""Walking with a leg under user control: allowed, and warned about."""

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    AtlasState,
)


def test_walking_with_a_user_leg_is_allowed_and_warned_about_once():
    sim = AtlasSimulation()
    command = AtlasSimInterfaceCommand()
    command.behavior = command.WALK
    for i in range(2):
        step = AtlasBehaviorStepData(step_index=i + 1, foot_index=i, duration=0.8)
        step.swing_height = 0.1
        step.pose.position.y = 0.14 if i == 0 else -0.14
        command.walk_params.step_queue[i] = step
    command.k_effort = [0] * sim.robot.num_joints
    command.k_effort[AtlasState.l_leg_akx] = 255
    sim.publish(command)
    sim.advance(0.2)
    warnings = [event.text for event in sim.events if event.kind == "warning"]
    assert len(warnings) == 1
    assert "l_leg_akx" in warnings[0]
    assert sim.current_behavior.name == "WALK"
