"""Films: the pictures of a log, the contents of the file, and wrong options."""

import json
import math
import signal

import numpy as np
import pytest
from pydrake.geometry import Mesh
from pydrake.math import RigidTransform

from atlas_drake import AtlasCommand, AtlasSimulation, Scenario, read_log
from atlas_drake.clients.cli.main import main
from atlas_drake.clients.film.camera import LAG, FilmCamera, looking_at
from atlas_drake.clients.film.file import FilmError, FilmFile, check_film
from atlas_drake.clients.film.film import RATE, film
from atlas_drake.clients.logs.header import Header
from atlas_drake.config import as_plain
from atlas_drake.frozen import replace
from atlas_drake.palette import BEHAVIOR, COM, FORCE, USER
from atlas_drake.scenario.scenario import LogContent
from atlas_drake.worlds.world_file import View, World

av = pytest.importorskip("av", reason='needs pip install "atlas-drake[video]"')

pytestmark = pytest.mark.usefixtures("restored_loggers")

SIZE = WIDTH, HEIGHT = 192, 108
SECONDS = 0.1


def frames(path):
    with av.open(str(path)) as video:
        return [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]


def differing(a, b, by=25):
    """Where two pictures differ visibly, shape (height, width)."""
    return np.abs(a.astype(int) - b.astype(int)).max(axis=2) > by


@pytest.fixture(scope="module")
def log_file(tmp_path_factory):
    """The log of a robot that stands, whose right half is the user's."""
    path = tmp_path_factory.mktemp("film") / "run.mcap"
    scenario = Scenario(log=LogContent(contacts=True))
    with AtlasSimulation(scenario, log=path) as sim:
        right = [255 * (name[:2] == "r_") for name in sim.robot.joint_names]
        sim.publish(AtlasCommand(k_effort=right))
        sim.advance(SECONDS)
    return path


@pytest.fixture(scope="module")
def log(log_file):
    return read_log(log_file)


@pytest.fixture(scope="module")
def picture(log, tmp_path_factory):
    """Returns the last picture of the log with some overlays, as it is encoded."""
    folder = tmp_path_factory.mktemp("pictures")

    def picture(*show, **options):
        path = folder / "film.gif"  # Its colors are nearly those of the picture.
        film(log, path, size=SIZE, show=show, **options)
        return frames(path)[-1]

    return picture


@pytest.fixture(scope="module")
def plain(picture):
    return picture()


# ---- file ----------------------------------------------------------------------


@pytest.mark.parametrize("ending", [".mp4", ".gif"])
def test_a_file_holds_the_pictures_that_were_added(ending, tmp_path):
    path = tmp_path / f"film{ending}"
    colors = ((40, 40, 40), (120, 120, 120), (235, 135, 50))
    with FilmFile(path, 25, (64, 48)) as file:
        for color in colors:
            file.add(np.full((48, 64, 3), color, dtype=np.uint8))
    found = frames(path)
    assert [picture.shape for picture in found] == 3 * [(48, 64, 3)]
    for picture, color in zip(found, colors, strict=True):
        assert np.abs(picture.astype(int) - color).max() < 8
    with av.open(str(path)) as video:
        assert video.streams.video[0].average_rate == 25


def test_a_film_that_cannot_be_made_is_refused(tmp_path, monkeypatch):
    check_film(tmp_path / "film.gif", (65, 47))
    with pytest.raises(FilmError, match="even"):
        check_film(tmp_path / "film.mp4", (65, 48))
    monkeypatch.setattr("atlas_drake.clients.film.file.find_spec", lambda _name: None)
    with pytest.raises(FilmError, match=r"atlas-drake\[video\]"):
        check_film(tmp_path / "film.mp4", (64, 48))


@pytest.mark.parametrize("name", ["a.gif", "a.mp4"])
def test_a_film_that_cannot_be_finished_is_deleted(name, tmp_path, largest_file):
    noise = np.random.default_rng(1).integers(0, 255, (100, 48, 64, 3), dtype=np.uint8)

    def film_noise():
        with FilmFile(tmp_path / name, 25, (64, 48)) as file:
            for picture in noise:
                file.add(picture)

    with largest_file(3000), pytest.raises(FilmError, match=name):
        film_noise()
    assert [*tmp_path.iterdir()] == []


# ---- camera --------------------------------------------------------------------


def at(record, x, yaw=0.0):
    """The record of a robot elsewhere."""
    q = record.state.q.copy()
    q[:5] = [math.cos(0.5 * yaw), 0.0, 0.0, math.sin(0.5 * yaw), x]
    return replace(record, state=replace(record.state, q=q))


def test_the_camera_looks_at_the_robot_from_the_front_and_upright(log):
    record = at(log.record(0), 1.0, yaw=0.5)
    X_WC = FilmCamera(None, 0.04).pose(record)
    x, y, z = X_WC.inverse() @ record.state.q[4:7]
    assert (x, y) == pytest.approx((0.0, 0.0), abs=0.1)
    assert z > 2.0
    heading = np.array([math.cos(0.5), math.sin(0.5), 0.0])
    assert heading @ (X_WC.translation() - record.state.q[4:7]) > 1.0
    right, down = X_WC.rotation().matrix()[:, 0], X_WC.rotation().matrix()[:, 1]
    assert right[2] == pytest.approx(0.0, abs=1e-12)
    assert down[2] < -0.9


def test_the_camera_follows_smoothly_unless_it_has_a_view(log):
    camera, record = FilmCamera(None, LAG / 25), log.record(0)
    begin = camera.pose(at(record, 0.0)).translation()
    for _ in range(25):
        moved = camera.pose(at(record, 1.0)).translation() - begin
    np.testing.assert_allclose(moved, [1.0 - math.exp(-1.0), 0.0, 0.0], atol=1e-9)
    camera = FilmCamera(View([3.0, 0.0, 1.0], [0.0, 0.0, 1.0]), 0.04)
    for x in (0.0, 1.0):
        X_WC = camera.pose(at(record, x))
        np.testing.assert_allclose(X_WC.translation(), [3.0, 0.0, 1.0])
        np.testing.assert_allclose(X_WC.rotation().matrix()[:, 2], [-1.0, 0.0, 0.0])


def test_a_camera_may_look_straight_down():
    X_WC = looking_at(np.array([0.0, 0.0, 5.0]), np.zeros(3))
    np.testing.assert_allclose(X_WC.inverse() @ np.zeros(3), [0, 0, 5.0], atol=1e-12)


# ---- pictures ------------------------------------------------------------------


@pytest.mark.slow
def test_the_robot_stands_in_the_picture(plain):
    # Of the robot, not of the ground, which looks the same along a row.
    rows, columns = np.nonzero(differing(plain, plain[:, :1], by=60))
    assert 0.6 * HEIGHT < np.ptp(rows) < HEIGHT - 2
    assert np.ptp(rows) > np.ptp(np.percentile(columns, [5, 95]))
    # Its feet are on the ground, its head before the sky.
    horizon = np.argmax(np.abs(np.diff(plain[:, 0].astype(int).sum(axis=1))))
    assert rows.min() < horizon < rows.max() - 0.3 * HEIGHT


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "color"), [("com", COM), ("forces", FORCE), ("support", None)]
)
def test_an_overlay_is_a_shape_in_the_picture(name, color, plain, picture):
    shown = picture(name)
    changed = differing(plain, shown, by=15)
    assert changed.any()
    if color is not None:
        nearest = np.abs(shown[changed] - 255.0 * np.array(color)).sum(axis=1).min()
        assert nearest < 100.0
    rows, _ = np.nonzero(changed)
    if name == "com":  # The ball is before the body, the disc on the ground.
        assert np.ptp(rows) > 0.2 * HEIGHT


@pytest.mark.slow
def test_links_have_the_color_of_their_owner(plain, picture):
    shown = picture("owner").astype(float)
    light = shown / np.linalg.norm(shown, axis=2, keepdims=True)
    like = {
        owner: light @ np.array(color) / np.linalg.norm(color) > 0.99
        for owner, color in (("behavior", BEHAVIOR), ("user", USER))
    }
    changed = differing(plain, shown)
    for owner, pixels in like.items():
        assert (pixels & changed).sum() > 0.002 * WIDTH * HEIGHT, owner
    # The robot faces the camera: its right side is left in the picture.
    left, right = (
        np.nonzero(like[o] & changed)[1].mean() for o in ("user", "behavior")
    )
    assert left < right - 3


@pytest.mark.slow
def test_a_world_with_a_view_is_filmed_from_there_unless_the_camera_follows(
    log, tmp_path, plain
):
    view = View([2.0, -3.0, 2.0], [0.0, 0.0, 0.9])
    scenario = replace(log.scenario, world=World(view=view))
    text = json.dumps(as_plain(scenario))
    told = replace(log, header=Header({**log.header.given, "scenario": text}))
    pictures = []
    for options in ({}, {"view": view}, {"show": ["follow"]}):
        film(told, tmp_path / "film.gif", size=SIZE, **options)
        pictures.append(frames(tmp_path / "film.gif")[-1])
    fixed, asked, following = pictures
    np.testing.assert_array_equal(fixed, asked)
    np.testing.assert_array_equal(following, plain)
    assert differing(fixed, following).mean() > 0.1


def test_a_mesh_that_cannot_be_drawn_is_named(log, tmp_path):
    mesh = tmp_path / "tetra.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n")

    def add(plant):
        plant.RegisterVisualGeometry(
            plant.world_body(), RigidTransform(), Mesh(str(mesh)), "mesh", np.ones(4)
        )

    with pytest.raises(FilmError, match="tetra"):
        film(log, tmp_path / "film.mp4", size=SIZE, world=[add])


# ---- command line --------------------------------------------------------------


@pytest.mark.slow
def test_a_log_is_filmed_beside_it(log_file, capsys):
    options = [
        "--size",
        f"{WIDTH}x{HEIGHT}",
        "--view",
        *["3", "-2", "1.5", "0", "0", "0.9"],
    ]
    assert main(["film", str(log_file), *options]) == 0
    path = log_file.with_suffix(".mp4")
    found = frames(path)
    assert len(found) == 1 + math.floor(SECONDS * RATE)
    assert str(path) in capsys.readouterr().out
    assert found[0].shape == (HEIGHT, WIDTH, 3)


@pytest.mark.slow
def test_ctrl_c_keeps_the_pictures_so_far(log_file, tmp_path, capsys, monkeypatch):
    path, add = tmp_path / "film.mp4", FilmFile.add

    def interrupted(file, picture):
        add(file, picture)
        if file.num_frames == 2:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(FilmFile, "add", interrupted)
    options = ["-o", str(path), "--size", "64x64"]
    assert main(["film", str(log_file), *options]) == 130
    assert len(frames(path)) == 2
    assert str(path) in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["-o", "TMP/a.avi"], ".mp4"),
        (["-o", "LOG"], "log"),
        (["--view", *"123"], "--view"),
        (["--view", *"123123"], "lens"),
    ],
)
def test_options_that_cannot_be_used_exit_with_2(
    options, word, log_file, tmp_path, capsys
):
    named = {"LOG": str(log_file)}
    line = [named.get(a, a.replace("TMP", str(tmp_path))) for a in options]
    with pytest.raises(SystemExit) as end:
        raise SystemExit(main(["film", str(log_file), *line]))
    assert end.value.code == 2
    assert word in capsys.readouterr().err


@pytest.mark.slow
def test_a_run_is_filmed_with_what_it_shows(tmp_path, capsys):
    scenario, path = tmp_path / "scenario.yaml", tmp_path / "film.gif"
    scenario.write_text("duration: 0.1\n")
    options = ["--headless", "--video", str(path), "--video-size", f"{WIDTH}x{HEIGHT}"]
    assert main(["run", str(scenario), *options, "--show", "forces"]) == 0
    assert f"{path}." in capsys.readouterr().out
    shown = frames(path)[-1]
    assert main(["run", str(scenario), *options]) == 0
    changed = differing(shown, frames(path)[-1])
    red, _, blue = shown[changed].mean(axis=0)
    assert red > blue + 50  # Yellow.
    assert {file.name for file in tmp_path.iterdir()} == {scenario.name, path.name}
