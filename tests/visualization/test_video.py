"""Videos: the contents of the file, and the refusal of invalid options."""

import importlib

import numpy as np
import pytest
from pydrake.geometry import Mesh, Meshcat
from pydrake.math import RigidTransform

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.app.main import main
from atlas_drake.palette import COM, FORCE
from atlas_drake.robot import load_robot
from atlas_drake.scenario.world_file import load_world
from atlas_drake.visualization.control_colors import owner_colors
from atlas_drake.visualization.footsteps import FootstepMark, Kind
from atlas_drake.visualization.overlay_shapes import overlay_shapes
from atlas_drake.visualization.overlays import OVERLAYS, Overlays
from atlas_drake.visualization.video_camera import (
    LAG,
    camera_pose,
    follow,
    looking_at,
)
from atlas_drake.visualization.video_display import VIDEO_RATE, Video, with_caption
from atlas_drake.visualization.video_file import VideoError, VideoFile, check_video
from atlas_drake.visualization.video_overlays import VideoOverlays
from atlas_drake.visualization.video_stage import VideoStage

av = pytest.importorskip("av", reason='needs pip install "atlas-drake[video]"')

WIDTH, HEIGHT = 192, 108
SOME_PIXELS = 0.01
"""Share of the picture that is more than noise."""


def frames(path):
    with av.open(str(path)) as video:
        return [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]


def differing(a, b, by=25):
    """Where two pictures differ visibly, shape (height, width)."""
    return np.abs(a.astype(int) - b.astype(int)).max(axis=2) > by


@pytest.mark.parametrize("ending", [".mp4", ".gif"])
def test_a_file_holds_the_pictures_that_were_added(ending, tmp_path):
    path = tmp_path / f"video{ending}"
    colors = ((40, 40, 40), (120, 120, 120), (235, 135, 50))
    file = VideoFile(path, 25, 64, 48)
    for color in colors:
        file.add(np.full((48, 64, 3), color, dtype=np.uint8))
    file.close()
    file.close()  # Once too often does no harm.
    found = frames(path)
    assert [picture.shape for picture in found] == 3 * [(48, 64, 3)]
    for picture, color in zip(found, colors, strict=True):
        assert np.abs(picture.astype(int) - color).max() < 8
    with av.open(str(path)) as video:
        assert video.streams.video[0].average_rate == 25


def test_options_of_a_video_that_cannot_be_used_are_refused(tmp_path, monkeypatch):
    with pytest.raises(VideoError, match=r"\.mp4 or \.gif"):
        check_video(tmp_path / "video.avi", 64, 48)
    with pytest.raises(VideoError, match="even"):
        check_video(tmp_path / "video.mp4", 65, 48)
    with pytest.raises(VideoError, match="there is no folder"):
        check_video(tmp_path / "none" / "video.mp4", 64, 48)
    check_video(tmp_path / "video.gif", 65, 47)
    VideoFile(tmp_path / "empty.mp4", 25, 64, 48).close()

    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(VideoError, match=r"pip install .*atlas-drake\[video\]"):
        check_video(tmp_path / "video.mp4", 64, 48)


def test_the_camera_looks_at_its_target_from_the_front_and_upright():
    target = np.array([1.0, 2.0, 0.9])
    X_WC = camera_pose(target, 0.5)
    p_CT = X_WC.inverse() @ target
    assert p_CT[:2] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert p_CT[2] > 2.0
    heading = np.array([np.cos(0.5), np.sin(0.5), 0.0])
    assert heading @ (X_WC.translation() - target) > 1.0
    right, down = X_WC.rotation().matrix()[:, 0], X_WC.rotation().matrix()[:, 1]
    assert right[2] == pytest.approx(0.0, abs=1e-12)
    assert down[2] < -0.9


def test_the_camera_follows_smoothly():
    still = follow(None, np.zeros(3), 0.04)
    assert follow(still, np.zeros(3), 0.04) == pytest.approx(still)
    target, moved = still, np.array([1.0, 0.0, 0.0])
    for _ in range(25):
        target = follow(target, moved, LAG / 25)
    assert target[0] == pytest.approx(1.0 - np.exp(-1.0))


@pytest.fixture(scope="module")
def stage():
    return VideoStage(load_robot(), [], WIDTH, HEIGHT)


@pytest.fixture(scope="module")
def q(sim):
    """Positions of robot and world."""
    return sim.plant.GetPositions(sim.plant.GetMyContextFromRoot(sim.context))


def test_the_robot_stands_in_the_picture(stage, q):
    X_WC = camera_pose(follow(None, q[4:7], 0.0), 0.0)
    away = q.copy()
    away[4:7] = [0.0, 0.0, -50.0]
    empty = stage.picture(away, [], X_WC)
    rows, columns = np.nonzero(differing(stage.picture(q, [], X_WC), empty))
    assert rows.size > SOME_PIXELS * WIDTH * HEIGHT
    # Upright: higher than wide, all of it in the picture.
    assert 0.5 * HEIGHT < np.ptp(rows) < HEIGHT - 2
    assert np.ptp(rows) > np.ptp(columns)
    # Its feet are where the ground is: below the horizon, above which is sky.
    sky = empty[0, 0].astype(int)
    ground = np.nonzero(np.abs(empty[:, 0].astype(int) - sky).max(axis=1) > 8)[0]
    assert rows.min() < ground.min() < rows.max()


def test_a_mesh_that_cannot_be_drawn_is_named(tmp_path):
    mesh = tmp_path / "tetra.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n")

    def add(plant):
        plant.RegisterVisualGeometry(
            plant.world_body(), RigidTransform(), Mesh(str(mesh)), "mesh", np.ones(4)
        )

    with pytest.raises(VideoError, match=f"no normals: {mesh}"):
        VideoStage(load_robot(), [], WIDTH, HEIGHT, [add])


def test_footsteps_appear_and_disappear(stage, q):
    X_WC = camera_pose(follow(None, q[4:7], 0.0), 0.0)
    mark = FootstepMark(Kind.LANDED, 1, 0.5, -0.3, 0.0)
    before = stage.picture(q, [], X_WC)
    during = stage.picture(q, [mark], X_WC)
    after = stage.picture(q, [], X_WC)
    seen = differing(before, during, by=15)
    assert seen.any()
    red, _, blue = during[seen].mean(axis=0)
    assert red > blue + 10  # The right foot's color is orange.
    assert not differing(before, after, by=15).any()


@pytest.mark.parametrize(
    ("name", "color"),
    [("com", COM), ("cop", None), ("support", None), ("forces", FORCE), ("plan", None)],
)
def test_an_overlay_is_drawn_over_the_robot(name, color, stage, q, sim, standing):
    X_WC = camera_pose(follow(None, q[4:7], 0.0), 0.0)
    plain = stage.picture(q, [], X_WC)
    shapes = overlay_shapes([name], standing)
    drawn = VideoOverlays(sim.robot, stage).onto(plain, shapes, None, X_WC)
    changed = differing(plain, drawn, by=10)
    if name == "plan":  # STAND has no path.
        assert not changed.any()
        return
    rows, _ = np.nonzero(changed)
    assert rows.size
    if color is not None:
        nearest = np.abs(drawn[changed] - 255.0 * np.array(color)).sum(axis=1).min()
        assert nearest < 40.0
    if name == "com":  # The ball is in the body, the disc on the ground.
        assert np.ptp(rows) > 0.2 * HEIGHT


def test_links_are_colored_by_their_owner(stage, q, sim):
    X_WC = camera_pose(follow(None, q[4:7], 0.0), 0.0)
    plain = stage.picture(q, [], X_WC)
    colors = owner_colors(np.array([0] * 16 + [255] * 12))
    picture = VideoOverlays(sim.robot, stage).onto(plain, [], colors, X_WC)
    red, _, blue = picture.astype(int).transpose(2, 0, 1)
    links = stage.links(X_WC)
    (foot,), (hand,) = stage.bodies(["l_foot"]), stage.bodies(["r_hand"])
    assert (blue - red)[links == foot].mean() > 20  # The behavior's.
    assert (red - blue)[links == hand].mean() > 20  # The user's.


def test_a_world_with_a_view_is_filmed_from_there_unless_the_camera_follows(tmp_path):
    video, scenario = Video(tmp_path / "a.mp4", WIDTH, HEIGHT), Scenario(world="stairs")
    pictures = []
    for overlays in (Overlays(), Overlays(["follow"])):
        sim = AtlasSimulation(scenario, video=video, overlays=overlays)
        sim.advance(0.01)
        sim.detach(*sim.sinks)
        pictures += frames(video.path)[:1]
    view = load_world("stairs").view
    lens, target = np.array(view.lens), np.array(view.target)
    X_WC = looking_at(lens, target)
    X_TC = RigidTransform(X_WC.rotation(), lens - target)
    terrain = scenario.all_terrain()
    stage = VideoStage(sim.robot, terrain, WIDTH, HEIGHT, X_TC=X_TC)
    expected = stage.picture(sim.record.state.q, [], X_WC)
    low = HEIGHT // 4  # Below the caption.
    fixed, following = (
        differing(found[low:], expected[low:]).mean() for found in pictures
    )
    assert fixed < SOME_PIXELS < 10.0 * SOME_PIXELS < following


def test_the_caption_is_in_the_corner():
    plain = np.full((540, 960, 3), 200, dtype=np.uint8)
    rows, columns = np.nonzero(differing(with_caption(plain, "walk", "x", 1.0), plain))
    assert rows.max() < 0.2 * 540
    assert columns.min() < 0.1 * 960
    other = with_caption(plain, "stand", "x", 1.0)
    assert differing(other, with_caption(plain, "walk", "x", 1.0)).any()


@pytest.mark.slow
def test_view_and_video_do_not_change_the_motion(tmp_path):
    path = tmp_path / "video.mp4"
    video, overlays = Video(path, WIDTH, HEIGHT), Overlays(OVERLAYS)
    scenario = Scenario(noise="reference", seed=3)
    filmed = AtlasSimulation(scenario, view=Meshcat(), video=video, overlays=overlays)
    plain = AtlasSimulation(scenario)
    for sim in (filmed, plain):
        sim.advance_to(0.1)
    states = [s.diagram.GetOutputPort("state").Eval(s.context) for s in (filmed, plain)]
    assert np.array_equal(*states)
    (sink,) = filmed.sinks
    assert filmed.detach(sink) == 3
    filmed.advance_to(0.2)  # What comes after the end is simulated, not filmed.
    assert len(frames(path)) == 3


@pytest.mark.slow
def test_a_run_becomes_a_film_of_the_robot(tmp_path, capsys):
    scenario, path = tmp_path / "scenario.yaml", tmp_path / "video.mp4"
    seconds = 0.2
    scenario.write_text(f"duration: {seconds}\n")
    options = ["--headless", "--video", str(path), "--video-size", f"{WIDTH}x{HEIGHT}"]
    assert main(["run", str(scenario), *options]) == 0
    found = frames(path)
    assert f"Wrote {path}, {len(found)} pictures." in capsys.readouterr().out
    assert len(found) == round(seconds * VIDEO_RATE)
    # Against a picture whose columns all look like the leftmost: no robot there.
    last = found[-1]
    rows, _ = np.nonzero(differing(last, np.repeat(last[:, :1], WIDTH, axis=1), by=60))
    assert np.ptp(rows) > 0.5 * HEIGHT
