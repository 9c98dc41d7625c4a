"""The numbers of a log by name, in Python and as tables of other programs."""

import numpy as np
import pandas
import pytest

from atlas_drake.clients.cli.main import main
from atlas_drake.clients.cockpit.describe import columns_of


def test_every_number_has_a_name_and_the_unit_of_the_run(run, numbers_on_page):
    sim, log = run
    numbers = numbers_on_page(sim, sim.record)
    for name, array in log.numbers.items():
        number = numbers.get(name, float("nan"))
        np.testing.assert_array_equal(array[-1], number, err_msg=name)
    columns = columns_of(sim.schema, sim.record)
    assert log.units == {name: columns[name]["unit"] for name in log.numbers}
    assert log.units["balance.dcm.x"] == "m"


def test_a_column_is_found_by_its_name_and_by_its_label(log):
    effort = log["joints.effort"]
    assert effort.shape == (len(log), 28)
    for index, joint in enumerate(log.robot.joint_names):
        np.testing.assert_array_equal(log[f"joints.effort.{joint}"], effort[:, index])
    assert np.nanmax(log["walk.t_step_rem"]) > 0.0
    with pytest.raises(KeyError, match=r"'joints\.position'"):
        log["joints.positon"]
    with pytest.raises(KeyError, match=r"balance\.com\.[xyz]"):
        log["balance.com.w"]


def read_npz(path):
    with np.load(path) as file:
        columns = {name: file[name] for name in file.files}
    labels = {name: columns.pop(f"{name}.labels", None) for name in [*columns]}
    table = {}
    for name, array in columns.items():
        if labels.get(name) is None:
            table[name] = array
        else:
            for index, label in enumerate(labels[name]):
                table[f"{name}.{label}"] = array[:, index]
    return pandas.DataFrame(table).set_index("time")


READERS = {
    ".parquet": pandas.read_parquet,
    ".csv": lambda path: pandas.read_csv(path, index_col="time", dtype=float),
    ".npz": read_npz,
}


@pytest.mark.parametrize("suffix", READERS)
def test_an_exported_table_has_every_number_to_the_bit(suffix, log, tmp_path):
    path = tmp_path / f"table{suffix}"
    assert main(["export", str(log.path), "--output", str(path)]) == 0
    table = READERS[suffix](path)
    assert [*table.columns] == [*log.numbers]
    np.testing.assert_array_equal(table.index, log.time)
    for name, numbers in log.numbers.items():
        np.testing.assert_array_equal(table[name], numbers, err_msg=name)
    if suffix != ".csv":
        assert table["joints.k_effort.l_leg_kny"].dtype == np.uint8
