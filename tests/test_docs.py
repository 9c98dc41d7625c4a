"""The pages are true: what they show runs, and the reference agrees with the code.

Comments in a page, above a block, tell what readers need not see:

    <!-- not run: REASON -->    only the command line is checked; in the first line of
                                a page this holds for all of it
    <!-- file: NAME -->         the commands of the page read the block as this file

Each block of Python runs by itself, as a reader would copy it.
"""

import importlib
import json
import re
import shlex
import shutil
from dataclasses import dataclass
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator, ValidationError
from pydrake.common.yaml import yaml_load
from referencing import Registry, Resource
from referencing.jsonschema import DRAFT202012

from atlas_drake.clients.cli.main import _parsed, main
from atlas_drake.clients.cli.run import with_options
from atlas_drake.clients.cli.sweep import _campaign
from atlas_drake.scenario import Scenario, load_scenario, scenario_from

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = ["README.md", "CONTRIBUTING.md", "models/README.md"]
PAGES += sorted(f"docs/{page.name}" for page in DOCS.glob("*.md"))
COMMENT = re.compile(r"<!-- (not run|file):\s((?:(?!-->).)+?)\s*-->\n\n", re.DOTALL)
BLOCK = re.compile(
    rf"(?:{COMMENT.pattern})?"
    r"(?:^```(?P<language>\w+)\n(?P<fenced>.*?)^```"
    r"|(?<=\n\n)(?P<shell>(?: {4}[^\n]*\n)+))",
    re.DOTALL | re.MULTILINE,
)
SHELL = re.compile(r"(\w+=\S+ )?(\.venv/bin/)?(atlas-drake|make|pip|python|dask)\b")
SPAN = re.compile(r"(?<!`)`((?:\.venv/bin/)?(?:atlas-drake \w+|make) [^`]+)`")
SHORTER = {
    "demo": ["--headless", "--set", "duration=0.1"],
    "run": ["--headless", "--set", "duration=0.1"],
    "teleop": ["--duration", "0.1"],
    "replay": ["--headless", "--record", "replay.html"],
    "sweep": ["--trials", "1", "--jobs", "1", "--set", "duration=0.2"],
}
"""What is added to a verb's command line, to run it briefly and without a browser."""


@dataclass
class Block:
    """Lines of a page between fences, or indented.

    Attributes:
        language: Word at the fence; empty for an indented block.
        note: Kind and text of the comment above it; two empty strings without one.
        line: Number of its first line, from 0.
        text: The lines.
    """

    language: str
    note: tuple[str, str]
    line: int
    text: str

    @property
    def commands(self):
        """Argument lists of the shell commands in an indented block."""
        if self.language:
            return []
        lines = self.text.replace("\\\n", " ").splitlines()
        shell = [line for line in map(str.strip, lines) if SHELL.match(line)]
        return [_words(line) for line in shell]


def _words(line):
    """A command line without variables, the folder of the program and comments."""
    words = shlex.split(line, comments=True)
    words = [word for word in words if not re.match(r"[A-Z_]+=", word)]
    return [words[0].removeprefix(".venv/bin/"), *words[1:]]


def blocks_of(page):
    """All blocks of a page, in their order."""
    text = (ROOT / page).read_text("utf-8")
    of_page = COMMENT.match(text)
    return [
        Block(
            language=found["language"] or "",
            note=(found[1] or "", found[2] or "") if not of_page else of_page.groups(),
            line=text[: found.start("fenced")].count("\n"),
            text=found["fenced"] or found["shell"],
        )
        for found in BLOCK.finditer(text)
    ]


@pytest.fixture
def workplace(tmp_path, monkeypatch):
    """A folder in which the commands of the pages find their files."""
    for name in ("benchmarks", "examples"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "robots").symlink_to(ROOT / "tests" / "robots")
    (tmp_path / "my_worlds").mkdir()
    shutil.copy(ROOT / "examples/scenarios/world/ball.sdf", tmp_path / "my_worlds")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write_files(blocks):
    """Writes the files that the commands of a page read."""
    for block in blocks:
        if block.note[0] == "file":
            Path(block.note[1]).write_text(block.text)


def run_page(page, together=False):
    """Runs a page from top to bottom; returns what its last Python has defined."""
    names = {"__name__": page}
    blocks = blocks_of(page)
    write_files(blocks)
    for block in [block for block in blocks if block.note[0] != "not run"]:
        if block.language == "python":
            if not together:
                names = {"__name__": page}
            # Empty lines before it, so that an error names the page's own line.
            exec(compile("\n" * block.line + block.text, page, "exec"), names)
        for program, *arguments in block.commands:
            if program != "atlas-drake" or "benchmarks/" in " ".join(arguments):
                continue  # Other tests run it; the next test sees that it is there.
            if arguments[0] == "diagram" and shutil.which("dot") is None:
                continue
            assert main([*arguments, *SHORTER.get(arguments[0], [])]) == 0, arguments
    return names


@pytest.mark.slow
@pytest.mark.usefixtures("workplace", "restored_loggers")
@pytest.mark.parametrize("page", sorted({*PAGES} - {"docs/in_your_diagram.md"}))
def test_a_page_runs_from_top_to_bottom(page):
    run_page(page)


@pytest.mark.parametrize("page", PAGES)
def test_command_lines_are_understood(page, workplace):
    """Also those that are not run, and those within a sentence."""
    blocks = blocks_of(page)
    write_files(blocks)
    text = BLOCK.sub("", (ROOT / page).read_text("utf-8"))
    commands = [command for block in blocks for command in block.commands]
    commands += [_words(span) for span in SPAN.findall(text)]
    targets = re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    for program, *arguments in commands:
        if program == "make":
            assert arguments[0] in targets
        elif program == "python" and arguments[0] != "-m":
            # Run by test_examples, test_extending or test_benchmarks.
            assert (ROOT / arguments[0]).is_file()
        elif program == "atlas-drake" and "--help" not in arguments:
            options = _parsed(_before_own(arguments))
            path = getattr(options, "scenario", None) or Path()
            if options.command in ("demo", "run", "script", "teleop"):
                found = load_scenario(path) if path.is_file() else Scenario()
                with_options(found, options)
            elif options.command == "sweep":
                assert options.campaign.is_file()
                if options.set:
                    _campaign(options)


def _before_own(arguments):
    """Arguments that are not those of a program that ``script`` runs."""
    return arguments[: [*arguments, "--"].index("--")]


@pytest.fixture(scope="module")
def generator():
    """Imports a module of docs/ by its name."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(DOCS))
        yield importlib.import_module


@pytest.mark.slow
def test_a_diagram_of_your_own_does_what_its_page_says(capsys):
    names = run_page("docs/in_your_diagram.md", together=True)
    first, second, third = capsys.readouterr().out.splitlines()
    height, elbow = map(float, re.findall(r"-?\d+\.\d+", first))
    assert height == pytest.approx(0.89, abs=0.02)
    assert elbow == pytest.approx(names["sine"].rest, abs=0.05)
    place = list(map(float, re.findall(r"-?\d+\.\d+", second)))
    assert place == pytest.approx([2.0, -1.0, 0.9], abs=0.03)
    assert float(re.search(r"\d\.\d+", third)[0]) < 0.02
    assert names["report"].pos_est.position.z > 0.85
    report = names["station"].GetOutputPort("atlas_sim_interface_state")
    assert report.Eval(names["context"]).pos_est.position.z > 0.85


def test_the_schemas_are_of_today(generator):
    found = {
        path.name: path.read_text("utf-8") for path in (DOCS / "schema").glob("*.json")
    }
    schemas = generator("json_schemas").schema_files()
    assert found == schemas, "run: python docs/json_schemas.py"


NAMED = re.compile(r"# yaml-language-server: \$schema=(\S+)\n")
WITH_SCHEMA = sorted(
    path
    for folder in ("examples/scenarios", "models", "benchmarks/campaigns")
    for path in (ROOT / folder).rglob("*.yaml")
)


@pytest.mark.parametrize("path", WITH_SCHEMA, ids=lambda path: path.stem)
def test_the_first_line_of_a_file_names_a_schema_that_it_keeps(path):
    text = path.read_text(encoding="utf-8")
    checker = schema_checker((path.parent / NAMED.match(text)[1]).resolve())
    checker.validate(yaml_load(data=text))
    # An unknown field is refused.
    with pytest.raises(ValidationError, match="unexpected"):
        checker.validate({**yaml_load(data=text), "colour": "red"})


def schema_checker(schema):
    known = Registry().with_resources(
        (one.name, Resource(json.loads(one.read_text(encoding="utf-8")), DRAFT202012))
        for one in schema.parent.glob("*.json")
    )
    return Draft202012Validator(known.contents(schema.name), registry=known)


@pytest.mark.parametrize(
    "text",
    [
        "controller: {walk: {limits: {duration: 0.7}}}",
        "controller: {walk: {limits: {duration: [0.7, 2.0]}}}",
        "noise: rough",
        "noise: {gyro: 0.1}",
        "state: true",
    ],
)
def test_the_schema_of_scenarios_takes_the_short_forms_of_values(text):
    checker = schema_checker(ROOT / "docs/schema/scenario.schema.json")
    checker.validate(yaml_load(data=text))
    scenario_from(yaml_load(data=text))
    with pytest.raises(ValidationError, match="loud"):
        checker.validate({"noise": "loud"})


def test_every_field_of_the_interfaces_messages_is_explained(generator):
    pages = generator("make_reference").all_pages()
    empty = [
        (page, line)
        for page, text in pages.items()
        if page.startswith(("Atlas", "Imu", "flags", "behaviors/"))
        for line in text.splitlines()
        if line.startswith("| `") and line.endswith("|  |")
    ]
    assert not empty


def test_links_and_named_files_exist():
    missing = []
    for page in (*(ROOT / page for page in PAGES), *DOCS.rglob("*/*.md")):
        text = page.read_text("utf-8")
        for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text):
            if not target.startswith(("http:", "https:")):
                missing += [] if (page.parent / target).exists() else [(page, target)]
        if page.name == "CONTRIBUTING.md":
            continue  # It names the files of a behavior to come.
        places = [ROOT / name for name in ("", "atlas_drake", "benchmarks", "examples")]
        places += [DOCS, page.parent]
        for name in re.findall(r"`((?:\w+/)*\w+\.py)`(?!\])", text):
            found = any((place / name).exists() for place in places)
            missing += [] if found else [(page, name)]
    assert missing == []
