"""Benchmarks: that they can be run, and that their figures have the names promised.

What they measure is judged where they are run, not here.
"""

import importlib
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "benchmarks"
SCRIPTS = sorted(
    path.stem for path in FOLDER.glob("*.py") if "def main" in path.read_text()
)


@pytest.fixture
def load(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_benchmark_explains_itself(load, name, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", [name, "--help"])
    with pytest.raises(SystemExit) as end:
        load(name).main()
    assert end.value.code == 0
    assert "--json" in capsys.readouterr().out


def test_speed_has_the_figures_promised(load, monkeypatch, capsys):
    realtime = load("realtime")
    monkeypatch.setattr(realtime, "DURATION", realtime.PIECE)
    result = realtime.measure("atlas")
    assert result["bare_upright"]
    assert result["sim_time"] == pytest.approx(realtime.PIECE)
    assert 0.0 < result["bare_step_ms"] < result["closed_loop_ms_per_step"]
    quotient = result["closed_loop_ms_per_step"] / result["bare_step_ms"]
    assert result["ratio"] == pytest.approx(quotient)
    assert result["real_time_factor"] > 0.0
    assert set(result["tick_ms"]) == {"median", "p99", "max"}
    realtime.print_table(result)
    assert "closed loop / bare plant" in capsys.readouterr().out
