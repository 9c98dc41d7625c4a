"""URDFs among the models that Drake fetches: a copy of them, and what cannot be had."""

import logging
import shutil
import threading
import time
import urllib.error
import urllib.request

import pytest

from atlas_drake.app.main import main
from atlas_drake.errors import RobotDescriptionError
from atlas_drake.robot import (
    LOCAL_MODELS,
    MODELS_FOLDER,
    load_robot,
    models_at_hand,
    packages,
)
from atlas_drake.robot.packages import ROS_PATH

from .conftest import HERON

URDF = "urdf: heron.urdf"


@pytest.fixture
def nowhere(tmp_path, monkeypatch):
    """No copy of the models, an empty cache, and a network that answers nothing."""
    for name in (LOCAL_MODELS, "TEST_TMPDIR", "XDG_CACHE_HOME", "DRAKE_ALLOW_NETWORK"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))

    def silent(*_arguments, **_options):
        raise urllib.error.URLError("no such host")

    monkeypatch.setattr(urllib.request, "urlopen", silent)
    monkeypatch.setattr(packages, "PackageMap", None)


def test_the_error_of_a_failed_download_says_what_to_set(nowhere, capsys):
    assert not models_at_hand()
    with pytest.raises(RobotDescriptionError, match="no such host") as caught:
        load_robot("drake_atlas")
    assert caught.value.field == "urdf"
    for words in (
        LOCAL_MODELS,
        "github.com/RobotLocomotion/models",
        "drake_atlas.yaml",
    ):
        assert words in str(caught.value)
    assert main(["demo", "--model", "drake_atlas", "--headless"]) == 2
    assert f"set {LOCAL_MODELS} to a folder" in capsys.readouterr().err


def test_a_network_that_hangs_is_not_waited_for(nowhere, monkeypatch):
    monkeypatch.setattr(packages, "PATIENCE", 0.05)
    patience = threading.Event()

    def hangs(*_arguments, **_options):
        patience.wait(10.0)
        raise urllib.error.URLError("too late")

    monkeypatch.setattr(urllib.request, "urlopen", hangs)
    start = time.monotonic()
    with pytest.raises(RobotDescriptionError, match=r"not answer within 0\.05 s"):
        load_robot("drake_atlas")
    assert time.monotonic() - start < 5.0
    patience.set()


def test_a_network_that_is_forbidden_is_not_asked(nowhere, monkeypatch):
    monkeypatch.setenv("DRAKE_ALLOW_NETWORK", "meshcat")
    with pytest.raises(RobotDescriptionError, match="DRAKE_ALLOW_NETWORK does not"):
        load_robot("drake_atlas")


def test_a_download_that_fails_says_why(nowhere, monkeypatch):
    class Broken:
        def GetPath(self, package):
            raise RuntimeError(f"{package}: checksum mismatch")

    def refused(*_arguments, **_options):
        # An answer, if not a friendly one.
        raise urllib.error.HTTPError("", 405, "not so", {}, None)

    monkeypatch.setattr(urllib.request, "urlopen", refused)
    monkeypatch.setattr(packages, "PackageMap", Broken)
    with pytest.raises(RobotDescriptionError, match="checksum mismatch; set ATLAS"):
        load_robot("drake_atlas")


def test_a_folder_without_the_model_is_named(tmp_path, monkeypatch):
    for folder in (tmp_path, tmp_path / "gone"):
        monkeypatch.setenv(LOCAL_MODELS, str(folder))
        with pytest.raises(RobotDescriptionError) as caught:
            load_robot("drake_atlas")
        assert f"{LOCAL_MODELS} names {folder}, which has no atlas/" in str(
            caught.value
        )
        # Other robots do not mind.
        assert load_robot(HERON).num_joints == 15


@pytest.mark.parametrize("in_ros_path", [False, True])
def test_packages_above_the_file_and_of_ros_are_known(
    copied, tmp_path, monkeypatch, in_ros_path
):
    package = tmp_path / "elsewhere" / "birds" if in_ros_path else tmp_path
    package.mkdir(parents=True, exist_ok=True)
    (package / "package.xml").write_text("<package><name>birds</name></package>")
    shutil.copy(MODELS_FOLDER / "meshes" / "head.gltf", package)
    mesh = (
        '<visual><geometry><mesh filename="package://birds/head.gltf"/>'
        "</geometry></visual>"
    )
    path = copied(('<link name="trunk">', f'<link name="trunk">{mesh}'))
    shutil.copy(path.parent / "heron.urdf", package)
    monkeypatch.setenv(ROS_PATH, str(package.parent) if in_ros_path else "")
    assert load_robot(path).num_joints == 15
    text = path.read_text()
    path.write_text(text.replace(URDF, "urdf: package://birds/heron.urdf"))
    assert load_robot(path).urdf == package / "heron.urdf"
    (package / "heron.urdf").unlink()
    with pytest.raises(RobotDescriptionError, match=r"no file .*heron\.urdf"):
        load_robot(path)


def test_other_packages_are_unknown(copied):
    path = copied()
    path.write_text(path.read_text().replace(URDF, "urdf: package://mine/heron.urdf"))
    with pytest.raises(
        RobotDescriptionError, match="mine is neither drake_models, nor"
    ):
        load_robot(path)
    (path.parent / "package.xml").write_text("<package>")
    with pytest.raises(RobotDescriptionError, match=r"package\.xml"):
        load_robot(path)


def test_a_copy_of_the_models_is_used(copied, tmp_path, monkeypatch):
    mesh = (
        '<visual><geometry><mesh filename="package://drake_models/heron/head.gltf"/>'
        "</geometry></visual>"
    )
    path = copied(('<link name="trunk">', f'<link name="trunk">{mesh}'))
    folder = tmp_path / "copy" / "heron"
    folder.mkdir(parents=True)
    shutil.move(path.parent / "heron.urdf", folder)
    shutil.copy(MODELS_FOLDER / "meshes" / "head.gltf", folder)
    text = path.read_text()
    path.write_text(text.replace(URDF, "urdf: package://drake_models/heron/heron.urdf"))
    monkeypatch.setenv(LOCAL_MODELS, str(folder.parent))
    robot = load_robot(path)
    assert robot.urdf == folder / "heron.urdf"
    assert robot.plant.num_actuators() == 15
    (folder / "head.gltf").unlink()
    with pytest.raises(RobotDescriptionError, match=r"head\.gltf.*not exist"):
        load_robot(path)


def test_drakes_warning_about_a_urdf_is_given_once(copied, caplog):
    unknown = '<safety_controller k_velocity="1" />\n    <axis xyz="0 1 0" />'
    path = copied(('<axis xyz="0 1 0" />', unknown))
    with caplog.at_level(logging.WARNING, logger="drake"):
        robot = load_robot(path)
        assert robot.plant.is_finalized()
    (warning,) = [r for r in caplog.records if "safety_controller" in r.getMessage()]
    assert "heron.urdf" in warning.getMessage()
