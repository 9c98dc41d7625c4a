"""The layers of the package, as defined in pyproject.toml."""

from importlinter.cli import lint_imports


def test_every_import_points_down_and_nothing_goes_round(capsys, monkeypatch):
    # It would disable the loggers that other tests read.
    monkeypatch.setattr("logging.config.dictConfig", lambda config: None)
    broken = lint_imports(no_cache=True)
    assert not broken, capsys.readouterr().out
