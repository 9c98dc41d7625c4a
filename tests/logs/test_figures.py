"""The page of figures: its contents, in both output formats."""

import re

import numpy as np
import pytest

from atlas_drake.frozen import replace
from atlas_drake.logs import png_page
from atlas_drake.logs.balance_figures import (
    balance_over_time,
    double_supports,
    feet_of,
    footprints,
    runs,
    view_from_above,
)
from atlas_drake.logs.figures import make_page
from atlas_drake.logs.log import LoggedEvent
from atlas_drake.logs.panels import Band, Heat, Line, Marker, Span, thinned
from atlas_drake.messages.event import Event

TITLES = {
    "Active behavior": "",
    "Whole-body QP": "",
    "Share of the user (k_effort)": "",
    "Efforts against their limits": "",
    "Left leg": "position [rad]",
    "Right leg": "position [rad]",
    "Left arm": "position [rad]",
    "Right arm": "position [rad]",
    "Back and neck": "position [rad]",
    "Controller ticks": "wall time [ms]",
    "From above": "y, to the left [m]",
    "Balance ahead": "x [m]",
    "Balance sideways": "y [m]",
    "Foot heights": "sole z [m]",
    "Foot forces": "vertical [N]",
    "Orientation of the pelvis": "angle [rad]",
    "Velocity of the pelvis in the world": "velocity [m/s]",
}


@pytest.fixture(scope="module")
def page(run):
    return make_page(run[1])


def panel(page, title):
    (found,) = [p for p in page.panels if p.title.startswith(title)]
    return found


def plain_title(text):
    return text.partition(" (")[0] if "k_effort" not in text else text


def test_behaviors_are_a_timeline(log, page):
    spans = panel(page, "Active behavior").items
    assert [span.label for span in spans] == ["STAND", "WALK"]
    assert spans[0].end == spans[1].start
    assert spans[1].start == pytest.approx(0.14, abs=log.header.control_period)
    assert spans[-1].end == log.time[-1]


def test_maps_show_shares_and_efforts(log, page):
    (shares,) = panel(page, "Share of the user").items
    np.testing.assert_array_equal(shares.values, log["joints.k_effort"].T)
    (efforts,) = panel(page, "Efforts").items
    assert efforts.names == log.robot.joint_names
    knee = log.robot.joint_index("l_leg_kny")
    share = np.abs(log["joints.effort"][:, knee]) / log.robot.effort_limit[knee]
    np.testing.assert_allclose(efforts.values[knee], share)


def test_set_points_are_shown_where_the_user_has_a_share(log, page):
    lines = panel(page, "Right arm").items
    dashed = [line for line in lines if line.dashed]
    assert len(dashed) == 1
    users = log["joints.k_effort"][:, log.robot.joint_index("r_arm_ely")] > 0
    np.testing.assert_array_equal(np.isnan(dashed[0].y), ~users)
    assert not any(line.dashed for line in panel(page, "Left arm").items)


def test_references_are_dashed_where_there_are_any(log):
    """STAND and WALK plan different ones, and a controller may plan none."""
    names = [f"balance.{name}_reference" for name in ("com", "dcm", "cop")]
    feet = feet_of(log)
    for given in (names, names[:1], []):
        arrays = {**log.arrays}
        for name in set(names) - set(given):
            arrays[name] = np.full_like(arrays[name], np.nan)
        part = replace(log, arrays=arrays)
        for drawn, column in (
            (view_from_above(part, feet), 1),
            (balance_over_time(part, feet, 0), 0),
            (balance_over_time(part, feet, 1), 1),
        ):
            plans = [i.y for i in drawn.items if isinstance(i, Line) and i.dashed]
            assert len(plans) == len(given), drawn.title
            for name, y in zip(given, plans, strict=True):
                np.testing.assert_array_equal(y, arrays[name][:, column])


def test_ticks_without_a_qp_are_not_shown_as_solved(log):
    rows = len(log)
    solved = np.ones(rows, dtype=int)
    solved[: rows // 2] = -1
    solved[-5:] = 0

    def labels(solved):
        arrays = {**log.arrays, "controller.solved": solved}
        page = make_page(replace(log, arrays=arrays))
        return [span.label for span in panel(page, "Whole-body QP").items]

    assert labels(solved) == ["solved", "no QP", "no solution"]
    assert labels(np.full(rows, -1)) == ["no QP"]
    assert labels(log["controller.solved"]) == ["solved"]


def test_the_cop_lies_in_the_support(log, page):
    items = panel(page, "Balance sideways").items
    (support,) = [item for item in items if isinstance(item, Band)]
    (cop,) = [i for i in items if isinstance(i, Line) and i.label == "CoP"]
    # The CoP comes from the forces of the tick before.
    later = slice(20, None)
    assert (cop.y[later] < support.high[later] + 1e-3).all()
    assert (cop.y[later] > support.low[later] - 1e-3).all()


def test_a_fall_is_marked_in_all_figures_over_time(log):
    fall = LoggedEvent(11, Event(0.1, "fall", "falling in STAND"), True)
    fallen = replace(log, logged=[*log.logged, fall])
    for p in make_page(fallen).panels:
        marked = any(isinstance(item, Marker) and item.x == 0.1 for item in p.items)
        assert marked == p.over_time, p.title


def test_standing_has_one_print_of_each_foot_and_one_polygon(log):
    feet = feet_of(log)
    assert [len(footprints(log, feet, foot)) for foot in (0, 1)] == [1, 1]
    (polygon,) = double_supports(log, feet)
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    np.testing.assert_allclose(high - low, [0.26, 0.41], atol=0.05)


def test_runs_are_where_flags_are_set():
    flags = np.array([1, 1, 0, 0, 1, 0, 1], dtype=bool)
    assert list(runs(flags)) == [(0, 2), (4, 5), (6, 7)]
    assert list(runs(np.zeros(3, dtype=bool))) == []


def test_a_thinned_curve_keeps_extremes_and_gaps():
    x = np.arange(10_000.0)
    y = np.sin(0.001 * x)
    y[1234], y[7777] = 9.0, -9.0
    y[5000:5003] = np.nan
    thin_x, thin_y = thinned(x, y, 200)
    assert len(thin_x) < 320
    assert 1234 in thin_x
    assert 7777 in thin_x
    assert np.isnan(thin_y).any()
    assert (np.diff(thin_x) > 0).all()
    np.testing.assert_array_equal(thinned(x[:50], y[:50], 200)[1], y[:50])


def test_a_thinned_map_keeps_the_highest_values():
    values = np.zeros((2, 1000))
    values[1, 333] = 0.7
    heat = Heat(np.arange(1000.0), ("a", "b"), values, 0, 1, ("#000000",), "")
    x, thin = heat.thinned(100)
    assert thin.shape == (2, 100)
    assert thin[1].max() == 0.7
    assert thin[0].max() == 0.0
    assert abs(x[thin[1].argmax()] - 333) < 10


def test_the_picture_has_every_figure_with_its_labels(page):
    figure = png_page.draw_figure(page)
    axes = {plain_title(a.get_title(loc="left")): a for a in figure.axes}
    axes.pop("", None)  # Color scales.
    assert {title: a.get_ylabel() for title, a in axes.items()} == TITLES
    assert axes["Foot forces"].get_xlabel() == "time [s]"
    assert axes["Foot forces"].get_xlim() == page.time
    assert axes["From above"].get_aspect() == 1.0
    labels = [t.get_text() for t in axes["Left leg"].get_legend().get_texts()]
    assert labels == ["hpz", "hpx", "hpy", "kny", "aky", "akx"]


@pytest.mark.slow
def test_no_titles_legends_or_figures_overlap(page):
    figure = png_page.draw_figure(page)
    figure.draw_without_rendering()
    boxes = []
    for axes in figure.axes:
        title = axes._left_title
        if title.get_text():
            boxes.append((title.get_text(), title.get_window_extent()))
        if axes.get_legend() is not None:
            name = f"legend of {title.get_text()}"
            boxes.append((name, axes.get_legend().get_window_extent()))
    for number, (name, box) in enumerate(boxes):
        assert figure.bbox.contains(box.x0, box.y0), name
        assert figure.bbox.contains(box.x1, box.y1), name
        for other, rival in boxes[:number]:
            assert not box.overlaps(rival), (name, other)


@pytest.mark.slow
def test_a_png_is_written(page, tmp_path, monkeypatch):
    monkeypatch.setattr(png_page, "DPI", 40)
    # What matplotlib would take for a formula, and one that it cannot read.
    page = replace(page, title=r"run_$\x$.mcap: atlas, scenario $^_$")
    png_page.write_png(page, tmp_path / "page.png")
    data = (tmp_path / "page.png").read_bytes()
    assert data.startswith(b"\x89PNG")
    width, height = (int.from_bytes(data[k : k + 4], "big") for k in (16, 20))
    assert width == 600
    assert height > width


@pytest.mark.slow
def test_the_web_page_is_whole_and_loads_nothing(page, tmp_path):
    pytest.importorskip("plotly")
    from atlas_drake.logs.html_page import draw, write_html

    file = tmp_path / "page.html"
    write_html(page, file)
    text = file.read_text()
    # The browser is told to refuse whatever is not in the file.
    policy = re.search(r'<head><meta http-equiv="Content-Security-Policy" (.*?)>', text)
    assert "default-src 'none'" in policy[1]
    assert "http" not in policy[1]
    outside = re.sub(r"<script\b.*?</script>", "", text, flags=re.DOTALL)
    assert "://" not in outside
    assert not re.search(r"<script[^>]*\bsrc=", text)
    assert "Foot forces" in text
    figure = draw(page)
    shown = [plain_title(a.text.strip("</b>")) for a in figure.layout.annotations]
    assert set(TITLES) <= set(shown)


def test_a_band_has_gaps_where_its_edges_are_nan():
    pytest.importorskip("plotly")
    from atlas_drake.logs.html_page import _band_polygons

    nothing = np.array([np.nan])
    edge = np.array([0.0, 0.0, np.nan, 1.0, 1.0, 1.0])
    x, y = _band_polygons(Band(np.arange(6.0), edge, edge + 2.0, "#000000"))
    pieces = np.split(x, np.flatnonzero(np.isnan(x)))
    assert [piece[1:].tolist() for piece in pieces if len(piece) > 1] == [
        [0, 1, 1, 0],
        [3, 5, 5, 3],
    ]
    assert np.nanmax(y) == 3.0
    empty = _band_polygons(Band(np.zeros(1), nothing, nothing, "#000000"))
    assert np.isnan(empty).all()


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("rows", [1, 2])
def test_short_logs_without_contact_can_be_drawn(log, rows):
    pytest.importorskip("plotly")
    from atlas_drake.logs.html_page import draw

    arrays = {name: array[:rows].copy() for name, array in log.arrays.items()}
    for side in ("left", "right"):
        arrays[f"feet.{side}_force"][:] = 0.0
    arrays["controller.tick_time"][:] = np.nan
    page = make_page(replace(log, arrays=arrays, logged=[]))
    png_page.draw_figure(page).draw_without_rendering()
    draw(page)


def test_every_kind_of_item_is_drawn_on_the_web_page(page):
    pytest.importorskip("plotly")
    from atlas_drake.logs.html_page import draw

    figure = draw(page)
    kinds = {type(item) for p in page.panels for item in p.items}
    assert kinds >= {Line, Band, Heat, Span}
    assert len(figure.data) == sum(len(p.items) for p in page.panels)
    times = figure.layout.xaxis4.range
    assert times == page.time
    # Between a panel and its title, two lines of the legend have room at any width.
    titles = [note for note in figure.layout.annotations if "<b>" in note.text]
    assert len(titles) == len(page.panels)
    line = 1.4 * figure.layout.legend.font.size
    assert all(title.yshift > 2.0 * line for title in titles)
