"""URDFs and meshes in packages: Drake's models, those above the file, and ROS'."""

import shutil

import pytest

from atlas_drake.errors import RobotDescriptionError
from atlas_drake.robot import LOCAL_MODELS, MODELS_FOLDER, load_robot

from .conftest import HERON

URDF = "urdf: heron.urdf"


@pytest.fixture
def with_head(copied):
    """Heron with a mesh of a package on its trunk; gives the YAML's path."""

    def write(package):
        mesh = (
            f'<visual><geometry><mesh filename="package://{package}/head.gltf"/>'
            "</geometry></visual>"
        )
        return copied(('<link name="trunk">', f'<link name="trunk">{mesh}'))

    return write


def test_models_that_cannot_be_fetched_say_what_to_set(tmp_path, monkeypatch):
    for name in (LOCAL_MODELS, "TEST_TMPDIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("DRAKE_ALLOW_NETWORK", "none")
    with pytest.raises(RobotDescriptionError) as caught:
        load_robot("drake_atlas")
    assert caught.value.field == "urdf"
    assert "\n" not in str(caught.value)
    for words in (LOCAL_MODELS, "RobotLocomotion/models", "drake_atlas.yaml"):
        assert words in str(caught.value)


def test_a_folder_without_the_model_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv(LOCAL_MODELS, str(tmp_path))
    with pytest.raises(RobotDescriptionError, match=LOCAL_MODELS) as caught:
        load_robot("drake_atlas")
    assert str(tmp_path) in str(caught.value)
    # Other robots do not mind.
    assert load_robot(HERON).num_joints == 15


@pytest.mark.parametrize("in_ros_path", [False, True])
def test_packages_above_the_file_and_of_ros_are_known(
    with_head, tmp_path, monkeypatch, in_ros_path
):
    package = tmp_path / "elsewhere" / "birds" if in_ros_path else tmp_path
    package.mkdir(parents=True, exist_ok=True)
    (package / "package.xml").write_text("<package><name>birds</name></package>")
    shutil.copy(MODELS_FOLDER / "meshes" / "head.gltf", package)
    path = with_head("birds")
    shutil.copy(path.parent / "heron.urdf", package)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(package.parent) if in_ros_path else "")
    assert load_robot(path).num_joints == 15
    text = path.read_text()
    path.write_text(text.replace(URDF, "urdf: package://birds/heron.urdf"))
    assert load_robot(path).urdf == package / "heron.urdf"
    (package / "heron.urdf").unlink()
    with pytest.raises(RobotDescriptionError, match=r"heron\.urdf"):
        load_robot(path)


def test_other_packages_are_unknown(copied):
    path = copied()
    path.write_text(path.read_text().replace(URDF, "urdf: package://mine/heron.urdf"))
    with pytest.raises(RobotDescriptionError, match="mine"):
        load_robot(path)
    (path.parent / "package.xml").write_text("<package>")
    with pytest.raises(RobotDescriptionError, match=r"package\.xml"):
        load_robot(path)


def test_a_copy_of_the_models_is_used(with_head, tmp_path, monkeypatch):
    path = with_head("drake_models/heron")
    folder = tmp_path / "copy" / "heron"
    folder.mkdir(parents=True)
    shutil.move(path.parent / "heron.urdf", folder)
    shutil.copy(MODELS_FOLDER / "meshes" / "head.gltf", folder)
    text = path.read_text()
    path.write_text(text.replace(URDF, "urdf: package://drake_models/heron/heron.urdf"))
    monkeypatch.setenv(LOCAL_MODELS, str(folder.parent))
    robot = load_robot(path)
    assert robot.urdf == folder / "heron.urdf"
    (folder / "head.gltf").unlink()
    with pytest.raises(RobotDescriptionError, match=r"link trunk.*head\.gltf"):
        load_robot(path)
