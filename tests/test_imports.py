"""The layers of the package, as defined in pyproject.toml."""

from importlinter.cli import lint_imports


def test_every_import_points_down_and_nothing_goes_round(capsys):
    broken = lint_imports(no_cache=True)
    assert not broken, capsys.readouterr().out
