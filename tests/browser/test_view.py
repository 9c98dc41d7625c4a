"""The 3D view in a browser: live, and as a recording without a network.

The page is queried for the contents of the scene; pixels show that they are visible.
"""

import json

import numpy as np
import pytest
from pydrake.geometry import Meshcat, MeshcatParams

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation
from atlas_drake.clients.view import FRAME_RATE
from atlas_drake.clients.view.colors import COVER, GAMMA, PAINT
from atlas_drake.clients.view.overlays import Overlays, overlays_from
from atlas_drake.palette import BEHAVIOR, USER

from .conftest import SIZE, picture

pytestmark = [pytest.mark.slow, pytest.mark.browser]

ROBOT = ["drake", "visualizer", "atlas"]
SHAPES = ["atlas_drake", "shapes"]
FOOTSTEPS = [*SHAPES, "footsteps"]
LINKS = ("pelvis", "utorso", "head", "l_foot", "r_foot", "l_hand", "r_hand")
VISIBLE = 30
"""Difference between two colors that anybody sees, of 255."""
FOOT_PIXELS = 6
"""How far a sole may seem to be from where the ground is [pixel]."""


def node(path):
    """JavaScript for a node of Meshcat's tree."""
    return f"viewer.scene_tree.find({json.dumps(path)})"


def wait_for_robot(page):
    """Until the meshes, which are loaded one by one, are all there."""
    page.wait_for_function("typeof viewer !== 'undefined'")
    page.wait_for_function(f"'pelvis' in {node(ROBOT)}.children")
    count = (
        f"(() => {{ let n = 0; {node(ROBOT)}.object.traverse("
        "o => { n += o.isMesh ? 1 : 0 }); return n })()"
    )
    page.wait_for_function(f"{count} >= {len(LINKS)}")
    seen = -1
    while seen != (now := page.evaluate(count)):
        seen = now
        picture(page)


def wait_for_recording(page):
    """Until everything is there, the motions too, which are loaded last."""
    wait_for_robot(page)
    page.wait_for_function("viewer.animator.duration > 0")


def position(page, link):
    """Of a link in W [m]; the browser's y axis points up."""
    matrix = f"{node([*ROBOT, link])}.object"
    x, y, z = page.evaluate(
        f"(() => {{ const o = {matrix}; o.updateWorldMatrix(true, false);"
        "return Array.from(o.matrixWorld.elements.slice(12, 15)) })()"
    )
    return np.array([x, -z, y])


def pixel(page, p_W):
    """Column and row at which a point is seen."""
    x, y, z = p_W
    u, v, width, height = page.evaluate(
        f"(() => {{ const c = viewer.camera; c.updateWorldMatrix(true, false);"
        f"const p = viewer.scene.position.clone().set({x}, {z}, {-y}).project(c);"
        "return [p.x, p.y, window.innerWidth, window.innerHeight] })()"
    )
    return 0.5 * (1 + u) * width, 0.5 * (1 - v) * height


def rows_and_columns_of_robot(page):
    """The pixels that change when the robot is hidden."""
    whole = picture(page)
    page.evaluate(f"{node(['drake'])}.object.visible = false")
    empty = picture(page)
    page.evaluate(f"{node(['drake'])}.object.visible = true")
    # A shadow darkens the ground a little; the robot differs more.
    return np.nonzero(np.abs(whole - empty).max(axis=2) > VISIBLE)


def shown(page, path):
    """Names of the things under a path that are visible."""
    return set(
        page.evaluate(
            f"Object.entries({node(path)}.children)"
            ".filter(([name, child]) => child.object.visible).map(([name]) => name)"
        )
    )


def check_that_it_stands(page):
    """The robot is seen as a whole, upright, with its feet on the ground."""
    where = {link: position(page, link) for link in LINKS}
    assert where["head"][2] > where["utorso"][2] > where["pelvis"][2] > 0.7
    rows, columns = rows_and_columns_of_robot(page)
    assert np.ptp(rows) > SIZE["height"] / 3
    assert np.ptp(rows) > 1.3 * np.ptp(columns)
    head_column, head_row = pixel(page, where["head"])
    assert rows.min() < head_row
    assert abs(np.median(columns) - head_column) < np.ptp(columns)
    soles = [pixel(page, [*where[foot][:2], 0.0])[1] for foot in ("l_foot", "r_foot")]
    assert abs(rows.max() - max(soles)) < FOOT_PIXELS + 0.05 * np.ptp(rows)


def test_a_run_is_seen_as_it_goes(open_page):
    meshcat = Meshcat(MeshcatParams(host="localhost"))
    sim = AtlasSimulation(view=meshcat)
    page = open_page(meshcat.web_url())
    wait_for_robot(page)
    check_that_it_stands(page)

    command = AtlasSimInterfaceCommand()
    command.behavior = command.MANIPULATE
    sim.publish(command)
    sim.advance(0.2)
    assert sim.current_behavior.name == "MANIPULATE"

    plant_context = sim.plant.GetMyContextFromRoot(sim.context)
    for link in LINKS:
        body = sim.plant.GetBodyByName(link)
        p_W = sim.plant.EvalBodyPoseInWorld(plant_context, body).translation()
        assert position(page, link) == pytest.approx(p_W, abs=0.005), link
    check_that_it_stands(page)


def seek(page, time):
    page.evaluate(f"viewer.animator.pause(); viewer.animator.seek({time})")


HEAD = [*ROBOT, "head", "atlas", "head_visual"]
STANDING, SWINGING, UNCOLOURED = 0.5, 1.5, 1.75
"""Moments of a run in which WALK is asked for at the start [s]."""


def record_thoughts(folder):
    """A walk with all overlays; the head is the user's from some time on."""
    meshcat = Meshcat()
    meshcat.StartRecording(
        frames_per_second=FRAME_RATE, set_visualizations_while_recording=False
    )
    overlays = Overlays(overlays_from("all"), recorded=True)
    sim = AtlasSimulation(view=meshcat, overlays=overlays)
    command = AtlasSimInterfaceCommand()
    command.behavior = command.WALK
    command.walk_params.use_demo_walk = True
    command.k_effort = [0] * sim.robot.num_joints
    sim.publish(command)
    sim.advance_to(1.0)
    command.k_effort[sim.robot.joint_names.index("neck_ry")] = 255
    sim.publish(command)
    sim.advance_to(1.6)
    overlays.switch("owner", False)
    sim.advance_to(1.8)
    file = folder / "thoughts.html"
    meshcat.StopRecording()
    meshcat.PublishRecording()
    file.write_text(meshcat.StaticHtml())
    return file


def look_at_the_ground(page):
    """From above and aside, so that nothing lies behind the legs."""
    page.evaluate(
        "viewer.handle_command({type: 'set_property', property: 'position',"
        " path: '/Cameras/default/rotated/<object>', value: [2.2, 1.6, 1.6]});"
        "viewer.handle_command({type: 'set_target', value: [0.1, 0.3, 0.0]})"
    )


def seen_of(page, path):
    """How many pixels change when something is hidden."""
    target = f"{node(path)}.object.visible"
    with_it = picture(page)
    before = page.evaluate(
        f"(() => {{ const v = {target}; {target} = false;return v }})()"
    )
    without = picture(page)
    page.evaluate(f"{target} = {json.dumps(before)}")
    return int((np.abs(with_it - without).max(axis=2) > VISIBLE).sum())


def arrow_heights(page):
    """How high the tips of the visible arrows are [m]."""
    forces = [*SHAPES, "forces"]
    heights = []
    for name in shown(page, forces):
        (number,) = shown(page, [*forces, name]) or {None}
        if number is None:
            continue
        arrow = f"{node([*forces, name, number, 'solid'])}.object"
        heights.append(
            page.evaluate(
                f"(() => {{ const o = {arrow}; o.updateWorldMatrix(true, false);"
                "return o.position.clone().set(0, 0, 1)"
                ".applyMatrix4(o.matrixWorld).y })()"
            )
        )
    return sorted(heights)


COVERS = [*HEAD[:-1], HEAD[-1] + COVER]


def color_of(page):
    """Of the copy that covers the head."""
    (copy,) = shown(page, COVERS)
    material = (
        f"(() => {{ let m; {node([*COVERS, copy])}.object.traverse("
        "o => { m = o.material || m }); return m.color.toArray() })()"
    )
    return page.evaluate(material)


def test_a_recording_plays_without_a_network_and_shows_plan_and_forces(
    open_page, tmp_path
):
    page = open_page(record_thoughts(tmp_path).as_uri(), offline=True)
    wait_for_recording(page)
    # Nothing was asked of any other address.
    asked = page.evaluate("performance.getEntriesByType('resource').map(e => e.name)")
    assert [name for name in asked if not name.startswith(("data:", "blob:"))] == []
    assert page.evaluate("viewer.animator.duration") == pytest.approx(1.8, abs=0.1)
    for name in ("slab", "bold"):
        assert page.evaluate(f"{node(['atlas_drake', 'ground', name])}.object.visible")
    seek(page, 0.0)
    check_that_it_stands(page)
    assert shown(page, FOOTSTEPS) == set()
    seek(page, SWINGING)
    assert len(shown(page, FOOTSTEPS)) >= 4  # To come; some have landed.
    look_at_the_ground(page)

    for shape in ("swing", "plan_dcm", "forces"):
        assert seen_of(page, [*SHAPES, shape]) > 30

    # Forward, back and forward again: what is seen depends on the moment alone.
    for _ in range(2):
        seek(page, SWINGING)
        swinging = {m: shown(page, [*SHAPES, m]) for m in ("support", "plan_dcm")}
        assert len(shown(page, [*SHAPES, "swing"])) == 1
        on_one_foot = arrow_heights(page)
        users = color_of(page)
        np.testing.assert_allclose(users, PAINT * np.power(USER, GAMMA), atol=0.01)
        assert not page.evaluate(f"{node(HEAD)}.object.visible")

        seek(page, STANDING)
        for mark, then in swinging.items():
            now = shown(page, [*SHAPES, mark])
            assert len(then) == 1, mark
            assert now != then, mark
        assert shown(page, [*SHAPES, "swing"]) == set()
        on_two_feet = arrow_heights(page)
        assert len(on_two_feet) == 8
        assert len(on_one_foot) <= 4
        assert max(on_one_foot) > 1.2 * max(on_two_feet)
        behaviors = color_of(page)
        np.testing.assert_allclose(
            behaviors, PAINT * np.power(BEHAVIOR, GAMMA), atol=0.01
        )

    assert seen_of(page, [*SHAPES, "support"]) > 100
    seek(page, UNCOLOURED)
    assert shown(page, COVERS) == set()
    assert page.evaluate(f"{node(HEAD)}.object.visible")
