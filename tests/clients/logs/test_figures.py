"""The figures of a log: what each of them shows."""

import numpy as np
import pytest
from matplotlib.colors import to_hex

from atlas_drake import LogError
from atlas_drake.clients.logs.figures import draw_channels, draw_page
from atlas_drake.clients.logs.footprints import soles_of
from atlas_drake.clients.logs.log import LoggedEvent
from atlas_drake.frozen import replace
from atlas_drake.messages.event import Event


def axes_of(figure):
    """The figures of a page by the beginnings of their titles."""
    titles = {axes: axes.get_title(loc="left") for axes in figure.axes}
    return {
        title.partition(" (")[0] if "k_effort" not in title else title: axes
        for axes, title in titles.items()
        if title
    }


@pytest.fixture(scope="module")
def page(log):
    return axes_of(draw_page(log))


def curves(axes, *, dashed=False):
    return [
        line
        for line in axes.lines
        if (line.get_linestyle() == "--") == dashed and line.get_label() != "_event"
    ]


def spans(axes):
    """Name, begin and end of the pieces of a timeline."""
    found = [(p.get_label()[1:], *p.get_extents().intervalx) for p in axes.patches]
    to_time = axes.transData.inverted()
    times = [
        (name, *to_time.transform([(x, 0) for x in ends])[:, 0])
        for name, *ends in found
    ]
    return sorted(times, key=lambda one: one[1])


def with_columns(log, **columns):
    arrays = {name.replace("__", "."): array for name, array in columns.items()}
    return replace(log, arrays=log.arrays | arrays)


@pytest.mark.slow
def test_the_page_has_every_figure_with_its_labels(log, page):
    assert len(page) == 17
    forces = page["Foot forces"]
    assert forces.get_ylabel() == "vertical [N]"
    assert forces.get_xlabel() == "time [s]"
    assert forces.get_xlim() == (0.0, log.time[-1] + log.header.control_period)
    assert page["From above"].get_aspect() == 1.0
    labels = [t.get_text() for t in page["Left leg"].get_legend().get_texts()]
    assert labels == ["hpz", "hpx", "hpy", "kny", "aky", "akx"]


@pytest.mark.parametrize(
    ("title", "columns"),
    [
        ("Right leg", [f"joints.position.r_leg_{j}" for j in ("hpz", "hpx", "hpy")]),
        ("Foot heights", ["feet.left_position.z", "feet.right_position.z"]),
        ("Foot forces", ["feet.left_force.z", "feet.right_force.z"]),
        (
            "Velocity of the pelvis in the world",
            [f"pelvis.velocity.{a}" for a in "xyz"],
        ),
        ("Balance sideways", [f"balance.{name}.y" for name in ("com", "dcm", "cop")]),
    ],
)
def test_curves_are_columns_over_time(title, columns, log, page):
    for line, column in zip(curves(page[title]), columns, strict=False):
        np.testing.assert_array_equal(line.get_xdata(), log.time)
        np.testing.assert_array_equal(line.get_ydata(), log[column])


def test_behaviors_are_a_timeline(log, page):
    axes = page["Active behavior"]
    (stand, begin, change), (walk, start, end) = spans(axes)
    assert (stand, walk) == ("STAND", "WALK")
    assert (begin, change) == pytest.approx((0.0, start))
    assert start == pytest.approx(0.14, abs=log.header.control_period)
    assert end == pytest.approx(log.time[-1])
    colors = [to_hex(patch.get_facecolor()) for patch in axes.patches]
    entries = {entry.name: entry.color for entry in log.header.catalog}
    assert {entries["STAND"], entries["WALK"]} == set(colors)


def test_ticks_without_a_qp_are_not_shown_as_solved(log):
    rows = len(log)
    solved = np.ones(rows, dtype=int)
    solved[: rows // 2] = -1
    solved[-5:] = 0
    axes = axes_of(draw_page(with_columns(log, controller__solved=solved)))
    names = [name for name, *_ in spans(axes["Whole-body QP"])]
    assert names == ["no report", "solved", "no solution"]


def test_maps_show_shares_and_efforts(log, page):
    names = [
        t.get_text() for t in page["Efforts against their limits"].get_yticklabels()
    ]
    assert tuple(names) == log.robot.joint_names
    (shares,) = page["Share of the user (k_effort)"].images
    np.testing.assert_array_equal(shares.get_array(), log["joints.k_effort"].T)
    (efforts,) = page["Efforts against their limits"].images
    share = np.abs(log["joints.effort"]) / log.robot.effort_limit
    np.testing.assert_allclose(efforts.get_array(), share.T)


def test_set_points_are_shown_where_the_user_has_a_share(log, page):
    (setpoint,) = curves(page["Right arm"], dashed=True)
    users = log["joints.k_effort.r_arm_ely"] > 0
    np.testing.assert_array_equal(np.isnan(setpoint.get_ydata()), ~users)
    assert setpoint.get_ydata()[-1] == 1.9
    assert curves(page["Left arm"], dashed=True) == []


@pytest.mark.slow
@pytest.mark.parametrize("names", [("com",), ()])
def test_references_are_dashed_where_there_are_any(names, log):
    """STAND and WALK plan different ones, and a controller may plan none."""
    missing = {
        f"balance__{name}_reference": np.full((len(log), 2), np.nan)
        for name in {"com", "dcm", "cop", "cmp"} - {*names}
    }
    axes = axes_of(draw_page(with_columns(log, **missing)))
    for title, column in (("Balance ahead", 0), ("Balance sideways", 1)):
        planned = curves(axes[title], dashed=True)
        for line, name in zip(planned, names, strict=True):
            reference = log[f"balance.{name}_reference"][:, column]
            np.testing.assert_array_equal(line.get_ydata(), reference)


def test_a_fall_is_marked_in_every_figure_over_time(log):
    fall = LoggedEvent(0, Event(0.1, "fall", "falling"), True)
    for title, axes in axes_of(draw_page(replace(log, logged=[fall]))).items():
        marks = [line for line in axes.lines if line.get_label() == "_event"]
        assert len(marks) == (title != "From above"), title
        assert all(mark.get_xdata()[0] == 0.1 for mark in marks)


def test_standing_has_one_print_of_each_foot_and_the_cop_in_its_support(log):
    soles = soles_of(log)
    assert [len(soles.footprints(foot)) for foot in (0, 1)] == [1, 1]
    (polygon,) = soles.double_supports()
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    np.testing.assert_allclose(high - low, [0.26, 0.41], atol=0.05)
    for axis in (0, 1):
        low, high = soles.extent(axis)
        cop = log["balance.cop"][:, axis]
        # The CoP comes from the forces of the tick before.
        inside = (low - 1e-3 <= cop) & (cop <= high + 1e-3)
        assert inside[np.isfinite(cop) & np.isfinite(low)].mean() > 0.95


def test_chosen_columns_are_drawn_one_figure_per_unit(log):
    patterns = ["balance.dcm", "*.velocity.l_leg_kny", "balance.com.z", "balance.dcm.x"]
    meters, speeds = draw_channels(log, patterns).axes
    names = ["balance.dcm.x", "balance.dcm.y", "balance.com.z"]
    curves = [line for line in meters.lines if line.get_label() != "_event"]
    assert [line.get_label() for line in curves] == names
    for line in (*curves, speeds.lines[-1]):
        np.testing.assert_array_equal(line.get_ydata(), log[line.get_label()])
    assert (meters.get_ylabel(), speeds.get_ylabel()) == ("[m]", "[rad/s]")
    with pytest.raises(LogError, match=r"'balance\.dcn'"):
        draw_channels(log, ["balance.dcn"])


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("rows", [1, 2])
def test_short_logs_without_contact_can_be_drawn(log, rows):
    arrays = {name: array[:rows].copy() for name, array in log.arrays.items()}
    for side in ("left", "right"):
        arrays[f"feet.{side}_force"][:] = 0.0
    arrays["controller.tick_time"][:] = np.nan
    # What matplotlib would take for a formula, and one that it cannot read.
    path = log.path.with_name(r"run_$\x$.mcap")
    figure = draw_page(replace(log, path=path, arrays=arrays, logged=[]))
    figure.draw_without_rendering()
